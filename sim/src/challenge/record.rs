//! Recordings of a simulated machine: flaws, noise and sampling of its sensors.

use socam_recording::Dataset;

use super::background::Background;
use super::machine::Machine;
use super::random::Draw;
use super::simulate::{FINE, Run, Signals};
use crate::SimError;
use crate::challenge::flaw::{Flaw, FlawedChannel};

impl Run {
    /// The recording of a simulated motion, with flaws, delays, noise and time stamps.
    ///
    /// # Errors
    /// When it has no samples.
    pub(super) fn record(
        &self,
        machine: &Machine,
        signals: &Signals,
        (flaws, background): (&[(String, Flaw)], &Background),
        noise_std: &[(String, f64)],
        name: &str,
    ) -> Result<Dataset, SimError> {
        let period_s = 1.0 / machine.rate_hz;
        let mut draw = Draw::new(self.noise_seed, 0);
        let channels = machine.channels();
        let mut columns = Vec::new();
        for (index, channel) in channels.iter().enumerate() {
            let mut values = signals.channels[index].clone();
            let own = flaws.iter().filter(|(place, _)| *place == channel.name);
            for (_, flaw) in own {
                apply(*flaw, &mut values, &signals.shafts[index], period_s / FINE as f64);
            }
            let delay = background.delay(&channel.name);
            let std = noise_std.iter().find(|(name, _)| *name == channel.name).map_or(0.0, |(_, std)| *std);
            let step = index.checked_sub(1).map_or(0.0, |sensor| machine.sensors[sensor].step);
            let mut column: Vec<f64> =
                (0..values.len() / FINE).map(|sample| late(&values, sample, delay)).collect();
            background.falsify(&channel.name, index == 0, &mut column);
            for value in &mut column {
                *value += std * draw.normal();
                if step > 0.0 {
                    *value = (*value / step).round() * step;
                }
            }
            columns.push(column);
        }
        let count = columns[0].len();
        let stamp = |sample: usize| (sample as f64 + background.jitter * draw.between(-1.0, 1.0)) * period_s;
        let time_s: Vec<f64> = (0..count).map(stamp).collect();
        Ok(Dataset::from_columns(name, channels, time_s, columns)?)
    }
}

/// Applies a sensor's flaw on the fine grid.
fn apply(flaw: Flaw, values: &mut [f64], shaft: &[f64], step_s: f64) {
    let mut channel = FlawedChannel::new(flaw);
    for (index, value) in values.iter_mut().enumerate() {
        *value = channel.pass(*value, index as f64 * step_s, step_s, shaft[index]);
    }
}

/// The value `delay_samples` before a sample.
fn late(values: &[f64], sample: usize, delay_samples: f64) -> f64 {
    let at = ((sample as f64 - delay_samples) * FINE as f64).max(0.0);
    let (before, share) = (at.floor() as usize, at.fract());
    let next = values.get(before + 1).unwrap_or(&values[before]);
    values[before] + share * (next - values[before])
}
