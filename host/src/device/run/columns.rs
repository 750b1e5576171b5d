//! Effect of a calibration on a run: the recorded columns, and channel names in faults.

use socam_core::{Fault, Flags, Sample};
use socam_recording::{Calibration, Channel};
use socam_sim::NO_TACHOMETER;

/// The recorded channels of a bench.
pub(crate) struct Columns {
    pub(crate) channels: Vec<Channel>,
    /// Whether each value is recorded, in the calibration's order, the command first.
    recorded: Vec<bool>,
}

impl Columns {
    pub(crate) fn of(calibration: &Calibration) -> Self {
        let all = calibration.recorded_channels();
        let recorded: Vec<bool> = all.iter().map(|channel| channel.name != NO_TACHOMETER).collect();
        let channels =
            all.into_iter().zip(&recorded).filter(|(_, recorded)| **recorded).map(|(channel, _)| channel);
        Self { channels: channels.collect(), recorded }
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
        &self,
        calibration: &Calibration,
        sample: &Sample,
        inputs: usize,
        values: &mut Vec<f64>,
    ) {
        let is_silent = sample.flags.has(Flags::NO_READING);
        let all = calibration.values(sample.output_count, &sample.counts[..inputs]);
        // The first value is the command, which is always known.
        let all = all.enumerate().map(|(i, value)| if i > 0 && is_silent { f64::NAN } else { value });
        values.extend(all.zip(&self.recorded).filter(|(_, recorded)| **recorded).map(|(value, _)| value));
    }
}

/// A fault in words, with the channels' names.
pub(crate) fn fault_text(fault: &Fault, calibration: &Calibration) -> String {
    let names: Vec<&str> = calibration.channels.iter().map(|channel| channel.channel.name.as_str()).collect();
    fault.with_names(&names).to_string()
}
