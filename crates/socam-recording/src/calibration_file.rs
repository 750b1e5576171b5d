//! The bench's calibration as TOML: what each channel measures, how volts become SI, and what is watched.

use std::path::Path;

use socam_core::scaling::{self, Converter, MotorCalibration, RAD_S_PER_RPM, Sensor, micro};
use socam_core::{ChannelKind, Config, ConfigError, MAX_CHANNELS, Output, SpeedControl};

use crate::settings::{self, Fields, SettingsError};
use crate::{Channel, Unit};

/// A bench's calibration, all in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The input converter.
    pub input: Converter,
    /// The output converter.
    pub output: Converter,
    /// Largest magnitude ever commanded, V.
    pub clamp_v: f64,
    /// Speed over command voltage.
    pub motor: MotorCalibration,
    /// How well that is known, where somebody measured it.
    pub motor_std: Option<MotorStd>,
    /// Closed-loop speed control.
    pub speed_control: SpeedGains,
    /// What ends a run.
    pub safety: Safety,
    /// The input channels, in the converter's order.
    pub channels: Vec<CalibratedChannel>,
}

/// Standard uncertainties of [`MotorCalibration`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorStd {
    /// rpm per V.
    pub rpm_per_volt: f64,
    /// rpm.
    pub offset_rpm: f64,
}

/// Gains of the closed speed loop.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedGains {
    /// Name of the channel that measures the motor's speed.
    pub tachometer: String,
    /// V per rad/s.
    pub proportional: f64,
    /// V per rad.
    pub integral_per_s: f64,
}

/// What ends a run, apart from the channels' own limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Safety {
    /// Longest silence of the host, s.
    pub host_timeout_s: f64,
    /// Samples in a row that must break a limit.
    pub confirm_samples: u8,
    /// From this command on the bench should move, V.
    pub moving_v: f64,
    /// How long a sensor may read nothing while the bench should move, s.
    pub missing_s: f64,
}

/// One input channel. Values are in the SI unit of `channel`.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibratedChannel {
    /// Name and SI unit.
    pub channel: Channel,
    /// Volts over SI.
    pub sensor: Sensor,
    /// Largest allowed magnitude.
    pub limit: Option<f64>,
    /// How long the same count may repeat while the bench moves, s.
    pub stuck_s: Option<f64>,
    /// A magnitude up to which the sensor reads "nothing".
    pub missing_below: Option<f64>,
    /// Standard uncertainty of the sensitivity, as a part of it, where somebody measured it.
    pub gain_std: Option<f64>,
    /// Standard uncertainty of the sensor's zero.
    pub offset_std: Option<f64>,
}

/// The default bench: the thesis' constants, and where those cannot be, the nearest ones that can.
const DEFAULT: &str = include_str!("calibrations/speed-o-cam.toml");

const SCHEMA: &str = "socam.calibration/1";

/// The name of the recorded command.
const COMMAND: &str = "command";

/// Units that a file may use, with the SI unit and how much of it one is.
const UNITS: [(&str, (Unit, f64)); 13] = [
    ("rad/s", (Unit::RadPerS, 1.0)),
    ("rpm", (Unit::RadPerS, RAD_S_PER_RPM)),
    ("krpm", (Unit::RadPerS, 1000.0 * RAD_S_PER_RPM)),
    ("N m", (Unit::Nm, 1.0)),
    ("N mm", (Unit::Nm, 1e-3)),
    ("rad", (Unit::Rad, 1.0)),
    ("m/s", (Unit::MPerS, 1.0)),
    ("m", (Unit::M, 1.0)),
    ("N", (Unit::N, 1.0)),
    ("V", (Unit::V, 1.0)),
    ("A", (Unit::A, 1.0)),
    ("K", (Unit::K, 1.0)),
    ("1", (Unit::One, 1.0)),
];

impl Default for Calibration {
    fn default() -> Self {
        let channel = |name: &str, unit, sensor, limit, missing_below| CalibratedChannel {
            channel: Channel::new(name, unit),
            sensor,
            limit: Some(limit),
            stuck_s: Some(1.0),
            missing_below,
            gain_std: None,
            offset_std: None,
        };
        let krpm = 1000.0 * RAD_S_PER_RPM;
        Self {
            input: Converter::DEFAULT,
            output: Converter::DEFAULT,
            clamp_v: 4.99,
            motor: MotorCalibration::LOADED,
            motor_std: None,
            speed_control: SpeedGains {
                tachometer: "motor_speed".to_owned(),
                proportional: 0.005,
                integral_per_s: 0.1,
            },
            safety: Safety { host_timeout_s: 0.5, confirm_samples: 1, moving_v: 0.5, missing_s: 0.5 },
            channels: vec![
                channel("motor_speed", Unit::RadPerS, Sensor::MOTOR_SPEED, 1.425 * krpm, Some(0.01 * krpm)),
                channel(
                    "output_speed",
                    Unit::RadPerS,
                    Sensor::OUTPUT_SPEED,
                    0.195_937_5 * krpm,
                    Some(0.001_25 * krpm),
                ),
                channel("torque_in", Unit::Nm, Sensor::TORQUE_IN, 4.8, None),
                channel("torque_out", Unit::Nm, Sensor::TORQUE_OUT, 38.0, None),
            ],
        }
    }
}

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

    /// Reads a calibration from its TOML text.
    pub fn parse(text: &str) -> Result<Self, SettingsError> {
        let default = Self::default();
        let mut fields = Fields::parse(text)?;
        fields.schema(SCHEMA);
        let input = fields.table("input", read_converter);
        let (output, clamp_v) = fields.table("output", |table| {
            let clamp_v = table.maybe_number("clamp_V", 1e-3..=1000.0).unwrap_or(default.clamp_v);
            (read_converter(table), clamp_v)
        });
        let (motor, motor_std) = fields.table("motor", |table| {
            let line = MotorCalibration {
                rpm_per_volt: table
                    .maybe_number("rpm_per_V", 1e-3..=1e6)
                    .unwrap_or(default.motor.rpm_per_volt),
                offset_rpm: table.maybe_number("offset_rpm", -1e4..=1e4).unwrap_or(default.motor.offset_rpm),
            };
            let gain_std = table.maybe_number("rpm_per_V_std", 0.0..=1e6);
            let offset_std = table.maybe_number("offset_rpm_std", 0.0..=1e6);
            let known = gain_std.zip(offset_std);
            (line, known.map(|(rpm_per_volt, offset_rpm)| MotorStd { rpm_per_volt, offset_rpm }))
        });
        let gains = default.speed_control;
        let speed_control = fields.table("speed_control", |table| SpeedGains {
            tachometer: table.maybe_text("tachometer").unwrap_or(gains.tachometer),
            proportional: table
                .maybe_number("proportional_V_per_rad_s", 0.0..=16.0)
                .unwrap_or(gains.proportional),
            integral_per_s: table
                .maybe_number("integral_V_per_rad", 0.0..=16.0)
                .unwrap_or(gains.integral_per_s),
        });
        let safety = fields.table("safety", |table| Safety {
            host_timeout_s: table
                .maybe_number("host_timeout_s", 0.01..=10.0)
                .unwrap_or(default.safety.host_timeout_s),
            confirm_samples: table
                .maybe_whole("confirm_samples", 1..=255)
                .map_or(default.safety.confirm_samples, |n| n as u8),
            moving_v: table.maybe_number("moving_V", 0.0..=1000.0).unwrap_or(default.safety.moving_v),
            missing_s: table.maybe_number("missing_s", 1e-3..=1000.0).unwrap_or(default.safety.missing_s),
        });
        let mut names = Vec::new();
        let channels = fields.tables("channel", |table| {
            let channel = read_channel(table);
            let name = channel.channel.name.clone();
            if name == COMMAND || names.contains(&name) {
                table
                    .complain(format!("a channel named `{name}` exists already; give each one its own name"));
            }
            names.push(name);
            channel
        });
        if channels.len() > MAX_CHANNELS {
            fields.complain(format!("{} channels; a board has at most {MAX_CHANNELS}", channels.len()));
        }
        fields.finish()?;
        Ok(Self { input, output, clamp_v, motor, motor_std, speed_control, safety, channels })
    }

    /// What a recording of this bench holds: the command in V, then the input channels.
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

fn read_converter(table: &mut Fields<'_>) -> Converter {
    let default = Converter::DEFAULT;
    Converter {
        bits: table.maybe_whole("bits", 8..=16).map_or(default.bits, |bits| bits as u8),
        full_scale_v: table.maybe_number("full_scale_V", 0.1..=1000.0).unwrap_or(default.full_scale_v),
    }
}

fn read_channel(table: &mut Fields<'_>) -> CalibratedChannel {
    let name = table.text("name");
    if !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') {
        table.complain(format!("`name` is \"{name}\"; expected letters, digits and underscores"));
    }
    let (unit, si) = table.choice("unit", &UNITS);
    let volts_per_unit = table.number("volts_per_unit", -1e6..=1e6);
    if volts_per_unit.abs() < 1e-9 {
        table.complain("`volts_per_unit` is 0; expected the sensor's sensitivity".to_owned());
    }
    CalibratedChannel {
        channel: Channel::new(name, unit),
        sensor: Sensor {
            volts_per_unit: volts_per_unit / si,
            offset_v: table.maybe_number("offset_V", -1000.0..=1000.0).unwrap_or(0.0),
        },
        limit: table.maybe_number("limit", 1e-6 / si..=2000.0 / si).map(|limit| limit * si),
        stuck_s: table.maybe_number("stuck_s", 1e-3..=1000.0),
        missing_below: table.maybe_number("missing_below", 0.0..=2000.0 / si).map(|below| below * si),
        gain_std: table.maybe_number("volts_per_unit_std", 0.0..=1e6).map(|std| std / volts_per_unit.abs()),
        offset_std: table
            .maybe_number("offset_V_std", 0.0..=1000.0)
            .map(|std| std / volts_per_unit.abs() * si),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_file_is_the_default_bench() {
        let read = Calibration::parse(Calibration::default_text()).unwrap();
        assert_eq!(read.config(1000).unwrap(), Config::default());
        assert_eq!(Calibration::default().config(1000).unwrap(), Config::default());
        let names: Vec<_> = read.recorded_channels().iter().map(Channel::column_name).collect();
        assert_eq!(
            names,
            ["command_V", "motor_speed_rad_s", "output_speed_rad_s", "torque_in_Nm", "torque_out_Nm"]
        );
        let sample: Vec<_> = read.values(16384, &[22609, 0, 1638, -32768]).collect();
        let expected = [5.0, 1000.0 * RAD_S_PER_RPM, 0.0, 0.25, -40.0];
        assert!(sample.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-3), "{sample:?}");
    }

    #[test]
    fn converters_of_twelve_bits_run_too() {
        let mut calibration = Calibration::default();
        calibration.input.bits = 12;
        calibration.output.bits = 12;
        let config = calibration.config(1000).unwrap();
        assert_eq!(config.output.count(config.output.clamp_uv), 1022);
        calibration.clamp_v = 10.0;
        assert!(calibration.config(1000).is_err());
    }

    #[test]
    fn complaints_name_line_key_and_expectation() {
        let complaint = |from: &str, to: &str| {
            let text = Calibration::default_text().replacen(from, to, 1);
            Calibration::parse(&text)
                .and_then(|calibration| calibration.config(1000))
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            complaint("bits = 16 ", "bits = 24 "),
            "line 6: `bits` is 24; expected a whole number from 8 to 16"
        );
        assert_eq!(
            complaint("limit = 4.8", "limits = 4.8"),
            "line 52: `limits` is not a key here; expected one of `name`, `unit`, `volts_per_unit`, `offset_V`, `limit`, \
             `stuck_s`, `missing_below`, `volts_per_unit_std`, `offset_V_std`"
        );
        assert_eq!(
            complaint("\"torque_out\"", "\"torque_in\"").split(';').next(),
            Some("line 55: a channel named `torque_in` exists already")
        );
        assert!(
            complaint("\"krpm\"", "\"mph\"").starts_with("line 31: `unit` is \"mph\"; expected \"rad/s\" or")
        );
        assert!(
            complaint("calibration/1", "calibration/2")
                .contains("this version reads \"socam.calibration/1\"")
        );
        assert!(
            complaint("tachometer = \"motor_speed\"", "tachometer = \"torque_in\"")
                .contains("no channel in rad/s")
        );
        assert!(complaint("clamp_V = 4.99", "clamp_V = 12").contains("the clamp exceeds the converter"));
    }
}
