//! The bench's calibration as TOML: what each channel measures, how volts become SI, and what is watched.

mod data;
mod parse;
#[cfg(test)]
mod tests;

use std::path::Path;

use socam_core::scaling::{self, Converter, micro};
use socam_core::{ChannelKind, Config, ConfigError, MAX_CHANNELS, Output, SpeedControl};

use crate::settings::{self, SettingsError};
use crate::{Channel, Unit};
use data::COMMAND;
pub use data::{CalibratedChannel, Calibration, MotorStd, Safety, SpeedGains};

/// The default bench: the thesis' constants, or the nearest possible ones.
const DEFAULT: &str = include_str!("../calibrations/speed-o-cam.toml");

impl Calibration {
    /// The TOML text of the default bench's calibration: a file to start from.
    #[must_use]
    pub fn default_text() -> &'static str {
        DEFAULT
    }

    /// Reads a calibration file.
    pub fn open(path: &Path) -> Result<Self, SettingsError> {
        Self::parse(&settings::read(path)?).map_err(|error| error.in_file(path))
    }

    /// Channels of a recording of this bench: the command in V, then the input channels.
    #[must_use]
    pub fn recorded_channels(&self) -> Vec<Channel> {
        let command = Channel::new(COMMAND, Unit::V);
        std::iter::once(command).chain(self.channels.iter().map(|channel| channel.channel.clone())).collect()
    }

    /// One sample in SI, in the order of [`Self::recorded_channels`].
    pub fn values<'a>(&'a self, output_count: i16, counts: &'a [i16]) -> impl Iterator<Item = f64> + 'a {
        let inputs = self.channels.iter().zip(counts);
        let inputs = inputs.map(|(channel, &count)| channel.sensor.value(self.input.volts(count)));
        std::iter::once(self.output.volts(output_count)).chain(inputs)
    }

    /// The board's integers for this bench, sampled at this period.
    pub fn config(&self, sample_period_us: u32) -> Result<Config, SettingsError> {
        let tachometer = self.channels.iter().position(|c| c.channel.name == self.speed_control.tachometer);
        let tachometer =
            tachometer.filter(|&i| self.channels[i].channel.unit == Unit::RadPerS).ok_or_else(|| {
                let name = &self.speed_control.tachometer;
                SettingsError::new(format!(
                    "the speed control's tachometer `{name}` is no channel in rad/s, rpm or krpm"
                ))
            })?;
        let mut channels = [socam_core::Channel::UNUSED; MAX_CHANNELS];
        for (slot, channel) in channels.iter_mut().zip(&self.channels) {
            *slot = channel.watched(&self.input);
        }
        let gains = &self.speed_control;
        let config = Config {
            sample_period_us,
            channel_count: self.channels.len() as u8,
            channels,
            output: Output {
                counts_per_uv_q32: scaling::counts_per_uv_q32(&self.output),
                clamp_uv: micro(self.clamp_v),
            },
            speed: SpeedControl::with_gains(
                &self.motor,
                tachometer as u8,
                gains.proportional,
                gains.integral_per_s,
            ),
            host_timeout_us: us(self.safety.host_timeout_s),
            confirm_samples: self.safety.confirm_samples,
            moving_uv: micro(self.safety.moving_v),
            missing_after_us: us(self.safety.missing_s),
        };
        let is_within = self.output.count(self.clamp_v) < self.output.highest_count();
        let sound = if is_within { config.check() } else { Err(ConfigError::Output) };
        sound.map_err(|error| SettingsError::new(format!("this calibration cannot run: {error}")))?;
        Ok(config)
    }
}

impl CalibratedChannel {
    fn watched(&self, converter: &Converter) -> socam_core::Channel {
        socam_core::Channel {
            kind: match self.channel.unit {
                Unit::RadPerS => ChannelKind::Speed,
                Unit::Nm => ChannelKind::Torque,
                _ => ChannelKind::Other,
            },
            scale: self.sensor.scale(converter),
            limit_micro: self.limit.map(micro),
            saturation_count: Some(converter.highest_count()),
            stuck_after_us: self.stuck_s.map(us),
            missing_below_micro: self.missing_below.map(micro),
        }
    }
}

fn us(seconds: f64) -> u32 {
    (seconds * 1e6).round() as u32
}
