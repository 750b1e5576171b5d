//! A virtual bench with the limits of the real one.

use socam_identify::NoiseLevels;
use socam_model::{Model, Quantity};
use socam_recording::{Dataset, ProfileFile, Waveform};
use socam_sim::{Setup, SimError};

use crate::DesignError;

/// Fraction of each limit that a proposal uses, as a margin for model errors.
const MARGIN: f64 = 0.9;
/// Sampling period of trial runs, us.
pub(crate) const PERIOD_US: u32 = 1000;
/// Factor beyond its excess by which a profile that violates a limit is attenuated, and the greatest number of attempts.
const SOFTER: f64 = 0.97;
const ATTEMPTS: usize = 4;

/// Limits of the command; those of torques and speeds are in the calibration's channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest command, V.
    pub voltage: f64,
    /// Fastest change of the command, V/s.
    pub slew_v_s: f64,
    /// Length of the recording, s, fading included.
    pub duration_s: f64,
    /// Whether the command must not change its sign.
    pub one_way: bool,
}

/// A bench that runs profiles.
#[derive(Debug, Clone)]
pub struct Rig {
    pub(crate) setup: Setup,
    pub(crate) limits: Limits,
}

/// A profile and its recording.
pub(crate) struct Run {
    pub(crate) profile: ProfileFile,
    pub(crate) data: Dataset,
}

impl Rig {
    /// A rig like `setup`; its calibration has the limits of its channels.
    ///
    /// # Errors
    /// When a limit is invalid.
    pub fn new(setup: Setup, limits: Limits) -> Result<Self, DesignError> {
        let refuse = |what, value, expected| Err(DesignError::Limit { what, value, expected });
        if !(limits.voltage > 0.0 && limits.voltage <= setup.calibration.clamp_v) {
            return refuse(
                "the largest command",
                limits.voltage,
                "volts above 0, at most the calibration's clamp_V",
            );
        }
        if !(0.01..=4000.0).contains(&limits.slew_v_s) {
            return refuse("the slew", limits.slew_v_s, "0.01 to 4000 V/s");
        }
        if !(2.0..=600.0).contains(&limits.duration_s) {
            return refuse("the duration", limits.duration_s, "2 to 600 s");
        }
        Ok(Self { setup, limits })
    }

    /// Limits of its command.
    #[must_use]
    pub fn limits(&self) -> Limits {
        self.limits
    }

    /// This rig with another model.
    pub(crate) fn with_setup(&self, setup: Setup) -> Self {
        Self { setup, limits: self.limits }
    }

    /// Noise levels of a model's channels: those of the model file, else those of the bench's sensors; inputs other than speeds count as
    /// exact, as in an identification.
    #[must_use]
    pub fn noise(&self, model: &Model) -> NoiseLevels {
        let noisy = Setup { noisy: true, ..self.setup.clone() };
        let of = |column: &str| {
            let channel = self.setup.calibration.channels.iter().find(|c| c.channel.column_name() == column);
            let step = channel.map_or(0.0, |channel| {
                let count = self.setup.calibration.input.volts_per_count();
                (if channel.is_transducer { 1.0 } else { count })
                    / channel.sensor.volts_per_unit.abs()
                    / 12_f64.sqrt()
            });
            noisy.noise_std_of_column(column).unwrap_or(0.0).hypot(step)
        };
        let known = |channel: &socam_model::Channel| {
            channel.noise_std.unwrap_or_else(|| of(&channel.column) * channel.scale.abs()).max(1e-12)
        };
        let input = |channel: &socam_model::Channel| match channel.quantity {
            Quantity::Speed => known(channel),
            _ => 0.0,
        };
        NoiseLevels {
            outputs: model.outputs().map(known).collect(),
            inputs: model.inputs().map(input).collect(),
        }
    }

    /// Runs a profile without noise, attenuated if it would violate a limit; `None` if that does not help.
    pub(crate) fn run(&self, profile: &ProfileFile) -> Result<Option<Run>, DesignError> {
        let mut profile = profile.clone();
        let mut free = Setup { noisy: false, ..self.setup.clone() };
        free.calibration.channels.iter_mut().for_each(|channel| channel.limit = None);
        for _ in 0..ATTEMPTS {
            let Ok(waveform) = profile.profile(PERIOD_US) else { return Ok(None) };
            let data = match free.record("proposal", &waveform, PERIOD_US) {
                Ok(data) => data,
                // A saturated converter violates the limits too.
                Err(SimError::Fault { .. }) => {
                    soften(&mut profile, 0.6);
                    continue;
                }
                Err(error) => return Err(error.into()),
            };
            let excess = self.excess(&data);
            if excess <= 1.0 {
                return Ok(Some(Run { profile, data }));
            }
            soften(&mut profile, SOFTER / excess);
        }
        Ok(None)
    }

    /// Largest ratio of a value to its limit, over all channels.
    fn excess(&self, data: &Dataset) -> f64 {
        let limit = |name: &str| {
            let channel = self.setup.calibration.channels.iter().find(|c| c.channel.name == name);
            channel.and_then(|channel| channel.limit)
        };
        let each = data.channels().iter().zip(data.statistics()).filter_map(|(channel, statistics)| {
            let largest = statistics.max?.abs().max(statistics.min?.abs());
            Some(largest / (MARGIN * limit(&channel.name)?))
        });
        each.fold(0.0, f64::max)
    }
}

/// Attenuates the motion about the mean; of a staircase, its steps.
fn soften(profile: &mut ProfileFile, factor: f64) {
    match &mut profile.waveform {
        Waveform::Multisine { amplitude, offset, .. }
        | Waveform::Chirp { amplitude, offset, .. }
        | Waveform::Prbs { amplitude, offset, .. }
        | Waveform::Sine { amplitude, offset, .. }
        | Waveform::Triangle { amplitude, offset, .. } => {
            *amplitude *= factor;
            // The mean is attenuated too if it violates a limit itself.
            if factor < 0.5 {
                *offset *= factor.sqrt();
            }
        }
        Waveform::Staircase { first, step, .. } => {
            *first *= factor;
            *step *= factor;
        }
        Waveform::Constant { level } => *level *= factor,
    }
}
