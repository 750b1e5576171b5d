//! The device's clock against the host's.
//!
//! A row cannot arrive before it was taken. So the smallest lag between the device's clock and the arrival, in each second, follows the
//! difference of the two clocks, and what is above is the delay of the link.

/// Most seconds that are kept singly; then pairs of them are joined.
const MOST: usize = 512;

/// The device's clock as a line over the host's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockMap {
    /// By which part the device's clock runs faster than the host's, 1.
    pub drift: f64,
    /// Largest distance of the smallest lags of a second from the line, s: the uncertainty of the map, to which the link's constant delay,
    /// which nothing here can measure, is to be added.
    pub uncertainty_s: f64,
    /// Largest delay of a row beyond the smallest of its second, s.
    pub latest_s: f64,
    /// Time over which the clocks were compared, s.
    pub over_s: f64,
}

/// Lags of arrivals behind the device's clock.
#[derive(Debug, Default)]
pub(super) struct Lags {
    /// Device and host time since the restart, ns.
    device_ns: i64,
    start_ns: i64,
    is_running: bool,
    /// Smallest lag since the restart, ns.
    least_ns: i64,
    /// Smallest lag of each bucket, at its device time, ns.
    buckets: Vec<(i64, i64)>,
    bucket_ns: i64,
    latest_ns: i64,
}

impl Lags {
    /// Begins anew at a row.
    pub(super) fn restart(&mut self, device_s: Option<f64>, arrival_ns: i64) {
        let latest_ns = self.latest_ns;
        *self = Self {
            start_ns: arrival_ns,
            is_running: device_s.is_some(),
            bucket_ns: 1_000_000_000,
            buckets: vec![(0, 0)],
            latest_ns,
            ..Self::default()
        };
    }

    fn lag_ns(&self, step_ns: i64, arrival_ns: i64) -> i64 {
        let host_ns = arrival_ns.saturating_sub(self.start_ns);
        host_ns.saturating_sub(self.device_ns.saturating_add(step_ns))
    }

    /// By how much a row after this step would arrive before it can, ns.
    pub(super) fn ahead_ns(&self, step_ns: i64, arrival_ns: i64) -> i64 {
        if !self.is_running {
            return 0;
        }
        self.least_ns.saturating_sub(self.lag_ns(step_ns, arrival_ns))
    }

    /// Takes a row.
    pub(super) fn take(&mut self, step_ns: i64, arrival_ns: i64) {
        let lag_ns = self.lag_ns(step_ns, arrival_ns);
        self.device_ns = self.device_ns.saturating_add(step_ns);
        self.least_ns = self.least_ns.min(lag_ns);
        let Some((at_ns, least_ns)) = self.buckets.last_mut() else { return };
        if self.device_ns - *at_ns < self.bucket_ns {
            self.latest_ns = self.latest_ns.max(lag_ns - *least_ns);
            *least_ns = (*least_ns).min(lag_ns);
        } else {
            self.buckets.push((self.device_ns, lag_ns));
        }
        if self.buckets.len() > MOST {
            let joined = self.buckets.chunks(2).map(|pair| {
                let least_ns = pair.iter().map(|(_, lag)| *lag).min().unwrap_or(0);
                (pair[0].0, least_ns)
            });
            self.buckets = joined.collect();
            self.bucket_ns *= 2;
        }
    }

    /// The line through the smallest lags.
    pub(super) fn map(&self) -> Option<ClockMap> {
        // The last bucket is not whole yet.
        let whole = self.buckets.get(..self.buckets.len().saturating_sub(1))?;
        if whole.len() < 2 {
            return None;
        }
        let points: Vec<(f64, f64)> =
            whole.iter().map(|(at, lag)| (*at as f64 * 1e-9, *lag as f64 * 1e-9)).collect();
        let count = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (middle_s, lag_s) = (mean(|p| p.0), mean(|p| p.1));
        let above: f64 = points.iter().map(|(at, lag)| (at - middle_s) * (lag - lag_s)).sum();
        let below: f64 = points.iter().map(|(at, _)| (at - middle_s).powi(2)).sum();
        let slope = above / below;
        let distance = |(at, lag): &(f64, f64)| (lag - lag_s - slope * (at - middle_s)).abs();
        Some(ClockMap {
            // A lag that grows is a device clock that runs slow.
            drift: -slope / (1.0 + slope),
            uncertainty_s: points.iter().map(distance).fold(0.0, f64::max),
            latest_s: self.latest_ns as f64 * 1e-9,
            over_s: points.last()?.0 - points[0].0,
        })
    }
}
