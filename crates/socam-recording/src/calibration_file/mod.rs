//! The bench's calibration as TOML: what each channel measures, how volts become SI, and what is watched.

mod data;
mod parse;
#[cfg(test)]
mod tests;

use std::path::Path;

use socam_core::scaling::{self, Converter, micro};
use socam_core::{
    ChannelKind, Config, ConfigError, GearmotorChannel, MAX_CHANNELS, MotorWatch, Output, Scale,
    SpeedControl, encoder, transducer,
};

use crate::settings::{self, SettingsError};
use crate::{Channel, Unit};
use data::COMMAND;
pub use data::{CalibratedChannel, Calibration, MotorStd, Safety, SpeedGains, Winding};

/// The default bench: the thesis' constants, or the nearest possible ones.
const DEFAULT: &str = include_str!("../calibrations/speed-o-cam.toml");

/// A gearmotor with an encoder on its motor and one on its output.
const GEARMOTOR: &str = include_str!("../calibrations/gearmotor.toml");

/// A torque transducer in place of the supply's current.
const TRANSDUCER: &str = include_str!("../calibrations/transducer.toml");

impl Calibration {
    /// The TOML text of a gearmotor board's calibration with a torque transducer: a file to start from.
    #[must_use]
    pub fn gearmotor_torque_text() -> String {
        let table = "[[channel]]";
        let mut parts = GEARMOTOR.split_inclusive(table);
        // What follows the table's header, to the header after it.
        let before: String = parts.by_ref().take(GearmotorChannel::SupplyCurrent.index() + 1).collect();
        let rest: String = parts.skip(1).collect();
        let before = before.strip_suffix(table).unwrap_or(&before);
        format!("{before}{TRANSDUCER}{table}{rest}")
    }

    /// The TOML text of a gearmotor board's calibration: a file to start from.
    #[must_use]
    pub fn gearmotor_text() -> &'static str {
        GEARMOTOR
    }

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

    /// One sample in SI, in the order of [`Self::recorded_channels`]; NaN where a transducer has no measurement in it.
    pub fn values<'a>(&'a self, output_count: i16, counts: &'a [i32]) -> impl Iterator<Item = f64> + 'a {
        let inputs = self.channels.iter().zip(counts);
        let volts_per_count = self.input.volts_per_count();
        let inputs = inputs.map(move |(channel, &count)| match channel.rad_per_count() {
            Some(rad_per_count) => f64::from(count) * rad_per_count,
            None if channel.is_transducer => channel.of_transducer(count),
            None => channel.sensor.value(f64::from(count) * volts_per_count),
        });
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
            motor: self.winding.map(Winding::watched),
        };
        let is_within = self.output.count(self.clamp_v) < self.output.highest_count();
        let sound = if is_within { config.check() } else { Err(ConfigError::Output) };
        sound.map_err(|error| SettingsError::new(format!("this calibration cannot run: {error}")))?;
        Ok(config)
    }
}

impl Winding {
    fn watched(self) -> MotorWatch {
        let index = |channel: GearmotorChannel| channel.index() as u8;
        MotorWatch {
            speed: index(GearmotorChannel::MotorSpeed),
            current: index(GearmotorChannel::MotorCurrent),
            voltage: index(GearmotorChannel::MotorVoltage),
            supply: index(GearmotorChannel::SupplyVoltage),
            resistance_q16: (self.resistance_ohm * 65_536.0).round() as i32,
            back_emf_q24: (self.back_emf_v_s * 16_777_216.0).round() as i32,
            after_us: us(self.contradiction_s),
            lowest_supply_uv: micro(self.lowest_supply_v),
        }
    }
}

impl CalibratedChannel {
    /// rad or rad/s per count of an encoder; `None` for a converter's channel.
    #[must_use]
    pub fn rad_per_count(&self) -> Option<f64> {
        let bits =
            if self.channel.unit == Unit::RadPerS { encoder::SPEED_BITS } else { encoder::POSITION_BITS };
        let per_turn = self.counts_per_turn?;
        Some(std::f64::consts::TAU / (per_turn * f64::from(1u32 << bits)))
    }

    /// The value of a transducer's count, SI; NaN where it is no measurement.
    fn of_transducer(&self, count: i32) -> f64 {
        if transducer::is_measured(count) { self.sensor.value(f64::from(count)) } else { f64::NAN }
    }

    fn scale(&self, converter: &Converter) -> Scale {
        if self.is_transducer {
            return Scale {
                micro_per_count_q16: (1e6 / self.sensor.volts_per_unit * 65_536.0).round() as i64,
                offset_micro: micro(self.sensor.value(0.0)),
            };
        }
        self.rad_per_count().map_or_else(
            || self.sensor.scale(converter),
            |rad| Scale { micro_per_count_q16: (rad * 1e6 * 65_536.0).round() as i64, offset_micro: 0 },
        )
    }

    fn watched(&self, converter: &Converter) -> socam_core::Channel {
        socam_core::Channel {
            kind: match (self.channel.unit, self.counts_per_turn) {
                _ if self.is_transducer => ChannelKind::Transducer,
                (Unit::RadPerS, Some(_)) => ChannelKind::EncoderSpeed,
                (_, Some(_)) => ChannelKind::EncoderAngle,
                (Unit::RadPerS, None) => ChannelKind::Speed,
                (Unit::Nm, None) => ChannelKind::Torque,
                (Unit::A, None) => ChannelKind::Current,
                _ => ChannelKind::Other,
            },
            scale: self.scale(converter),
            limit_micro: self.limit.map(micro),
            saturation_count: (self.counts_per_turn.is_none() && !self.is_transducer)
                .then(|| converter.highest_count()),
            stuck_after_us: self.stuck_s.map(us),
            missing_below_micro: self.missing_below.map(micro),
        }
    }
}

fn us(seconds: f64) -> u32 {
    (seconds * 1e6).round() as u32
}
