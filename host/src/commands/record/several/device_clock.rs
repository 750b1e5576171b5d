//! Times of a device on the host's clock, while it is recorded.
//!
//! A row cannot arrive before it was taken, so the smallest lag of arrivals behind the device's clock follows the difference of the
//! clocks. The map follows it slowly, so that steps of time stay those of the device.

use crate::device::source::Row;

/// Length of a part over which the smallest lag is taken, ns, and number of parts that the map follows.
const PART_NS: i64 = 1_000_000_000;
const PARTS: usize = 10;
/// Largest change of the map, s per s: beyond the drift of any clock, and too slow to be seen in a speed.
const SLEW: f64 = 1e-3;

/// A map from times of a device to those of the host.
#[derive(Debug, Default)]
pub(super) struct DeviceClock {
    /// Begin, ns, and smallest lag, ns, of the latest parts.
    parts: Vec<(i64, i64)>,
    /// Last time and the lag that is added to it, ns.
    last: Option<(i64, f64)>,
    /// Largest distance of a part's smallest lag from the map, ns.
    distance_ns: f64,
}

impl DeviceClock {
    /// Learns from a row of a device, if the device has a clock.
    pub(super) fn take(&mut self, row: &Row) {
        if row.is_new_clock {
            self.restart();
        }
        if row.has_clock {
            self.learn(row.time_ns, row.arrival_ns);
        }
    }

    /// Learns from a row: its time by the device and its arrival, ns.
    fn learn(&mut self, time_ns: i64, arrival_ns: i64) {
        let lag_ns = arrival_ns.saturating_sub(time_ns);
        match self.parts.last_mut() {
            Some((begin_ns, least_ns)) if time_ns - *begin_ns < PART_NS => {
                *least_ns = (*least_ns).min(lag_ns)
            }
            _ => {
                if let (Some((_, least_ns)), Some((_, used_ns))) = (self.parts.last(), self.last) {
                    self.distance_ns = self.distance_ns.max((*least_ns as f64 - used_ns).abs());
                }
                self.parts.push((time_ns, lag_ns));
                if self.parts.len() > PARTS {
                    self.parts.remove(0);
                }
            }
        }
    }

    /// The device's clock begins anew: the lag is another one from now on.
    fn restart(&mut self) {
        (self.parts, self.last) = (Vec::new(), None);
    }

    /// The time of a row that was learned, on the host's clock, ns.
    pub(super) fn host_ns(&mut self, time_ns: i64) -> i64 {
        let Some(least_ns) = self.parts.iter().map(|(_, least_ns)| *least_ns as f64).reduce(f64::min) else {
            return time_ns;
        };
        let used_ns = match self.last {
            None => least_ns,
            Some((last_ns, used_ns)) => {
                let most_ns = SLEW * (time_ns - last_ns).max(0) as f64;
                used_ns + (least_ns - used_ns).clamp(-most_ns, most_ns)
            }
        };
        self.last = Some((time_ns, used_ns));
        time_ns + used_ns as i64
    }

    /// Uncertainty of the times beside the link's constant delay, s; `None` of a device without a clock.
    pub(super) fn uncertainty_s(&self) -> Option<f64> {
        self.last.map(|_| self.distance_ns * 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock that runs 200 ppm slow, behind a link of 0 to 8 ms: times on the host's clock are right, and the stated uncertainty holds.
    #[test]
    fn a_clock_that_drifts_is_mapped_within_the_stated_uncertainty() {
        let mut clock = DeviceClock::default();
        let mut worst_ns = 0.0_f64;
        for k in 0..60_000_i64 {
            let host_ns = 1_000_000 * k;
            let device_ns = (host_ns as f64 * 0.9998) as i64;
            let delay_ns = (k * 7919 % 8000) * 1000;
            clock.learn(device_ns, host_ns + 5_000_000_000 + delay_ns);
            let mapped_ns = clock.host_ns(device_ns) - 5_000_000_000;
            if k > 2000 {
                worst_ns = worst_ns.max((mapped_ns - host_ns).abs() as f64);
            }
        }
        // The smallest lag of ten seconds is that of the latest by the drift of ten seconds: 2 ms.
        assert!(worst_ns < 2.5e6, "{worst_ns}");
        let uncertainty_s = clock.uncertainty_s().unwrap();
        assert!(uncertainty_s > 0.5e-9 * worst_ns && uncertainty_s < 8e-3, "{uncertainty_s}");
    }

    #[test]
    fn steps_stay_those_of_the_device() {
        let mut clock = DeviceClock::default();
        let mut last: Option<i64> = None;
        for k in 0..10_000_i64 {
            clock.learn(1_000_000 * k, 1_000_000 * k + if k == 5000 { -3_000_000 } else { 0 });
            let now = clock.host_ns(1_000_000 * k);
            if let Some(last) = last {
                assert!((now - last - 1_000_000).abs() <= 1001, "{k}");
            }
            last = Some(now);
        }
    }
}
