//! Effect of a calibration on a run: the recorded columns, and channel names in faults.

use socam_core::{Fault, Flags, MAX_CHANNELS, Sample};
use socam_recording::{Calibration, Channel, Unit};
use socam_sim::NO_TACHOMETER;

/// The recorded channels of a bench.
pub(crate) struct Columns {
    pub(crate) channels: Vec<Channel>,
    /// Whether each value is recorded, in the calibration's order, the command first.
    recorded: Vec<bool>,
    /// The counts of the latest sample, and how often each angle's has wrapped.
    latest: Option<[i32; MAX_CHANNELS]>,
    wraps: [i32; MAX_CHANNELS],
}

impl Columns {
    pub(crate) fn of(calibration: &Calibration) -> Self {
        let all = calibration.recorded_channels();
        let recorded: Vec<bool> = all.iter().map(|channel| channel.name != NO_TACHOMETER).collect();
        let channels =
            all.into_iter().zip(&recorded).filter(|(_, recorded)| **recorded).map(|(channel, _)| channel);
        Self { channels: channels.collect(), recorded, latest: None, wraps: [0; MAX_CHANNELS] }
    }

    /// The values of recorded channels, out of one value for each channel.
    #[cfg(feature = "window")]
    pub(crate) fn recorded<T>(&self, all: Vec<T>) -> Vec<T> {
        all.into_iter()
            .zip(&self.recorded)
            .filter(|(_, recorded)| **recorded)
            .map(|(value, _)| value)
            .collect()
    }

    /// Appends a sample's values, NaN where the board had no reading.
    pub(crate) fn read(
        &mut self,
        calibration: &Calibration,
        sample: &Sample,
        inputs: usize,
        values: &mut Vec<f64>,
    ) {
        self.count_wraps(sample);
        let is_silent = sample.flags.has(Flags::NO_READING);
        let all = calibration.values(sample.output_count, &sample.counts[..inputs]);
        let whole = calibration.channels.iter().zip(self.wraps).map(|(channel, wraps)| {
            let is_angle = channel.channel.unit == Unit::Rad;
            let rad = channel.rad_per_count().filter(|_| is_angle && wraps != 0);
            rad.map_or(0.0, |rad| f64::from(wraps) * 4_294_967_296.0 * rad)
        });
        // The first value is the command, which is always known.
        let all = all.zip(std::iter::once(0.0).chain(whole)).map(|(value, whole)| value + whole);
        let all = all.enumerate().map(|(i, value)| if i > 0 && is_silent { f64::NAN } else { value });
        values.extend(all.zip(&self.recorded).filter(|(_, recorded)| **recorded).map(|(value, _)| value));
    }

    /// An angle's count of 32 bits that jumps by more than half of its range has wrapped.
    fn count_wraps(&mut self, sample: &Sample) {
        if sample.flags.has(Flags::NO_READING) {
            return;
        }
        if let Some(latest) = self.latest {
            for ((wraps, before), now) in self.wraps.iter_mut().zip(latest).zip(sample.counts) {
                let difference = i64::from(now) - i64::from(before);
                *wraps += i32::from(difference < -(1 << 31)) - i32::from(difference > 1 << 31);
            }
        }
        self.latest = Some(sample.counts);
    }
}

/// A fault in words, with the channels' names.
pub(crate) fn fault_text(fault: &Fault, calibration: &Calibration) -> String {
    let names: Vec<&str> = calibration.channels.iter().map(|channel| channel.channel.name.as_str()).collect();
    fault.with_names(&names).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_goes_on_where_its_count_of_32_bits_wraps() {
        let calibration = Calibration::parse(Calibration::gearmotor_text()).unwrap();
        let mut columns = Columns::of(&calibration);
        let mut angles = Vec::new();
        for step in 0..6 {
            let mut counts = [0; MAX_CHANNELS];
            counts[0] =
                (i32::MAX - 32000).wrapping_add(if step < 4 { step * 16384 } else { (7 - step) * 16384 });
            let mut values = Vec::new();
            columns.read(&calibration, &Sample { counts, ..Sample::default() }, MAX_CHANNELS, &mut values);
            angles.push(values[1]);
        }
        // 16384 sixteenths of a count are a turn of 1024.
        let turns: Vec<f64> =
            angles.windows(2).map(|pair| (pair[1] - pair[0]) / std::f64::consts::TAU).collect();
        for (turn, expected) in turns.iter().zip([1.0, 1.0, 1.0, 0.0, -1.0]) {
            assert!((turn - expected).abs() < 1e-6, "{turns:?}");
        }
    }
}
