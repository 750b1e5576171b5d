//! The bench's configuration on the board: scales, limits, timing. Integers only; the host makes it from a calibration.

mod checks;
mod error;

pub use error::ConfigError;

use crate::count::Count;
use crate::layout::{Layout, MAX_CHANNELS};
use crate::motor_watch::MotorWatch;
use crate::scaling::{self, Converter, MotorCalibration, MotorLine, Scale, Sensor};

/// The configuration of a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config {
    /// Time between two ticks.
    pub sample_period_us: u32,
    /// Number of `channels` that exist and are read.
    pub channel_count: u8,
    /// The input channels, in the converter's order.
    pub channels: [Channel; MAX_CHANNELS],
    /// The command output.
    pub output: Output,
    /// Conversion of a commanded speed to a voltage.
    pub speed: SpeedControl,
    /// Longest time without a request of the host while armed, running or stopping.
    pub host_timeout_us: u32,
    /// Consecutive samples beyond a channel's limit, or at the converter's rail, that are a fault; 1: the first one is.
    pub confirm_samples: u8,
    /// Magnitude of the output from which the bench is expected to move.
    pub moving_uv: i32,
    /// Longest time of a missing signal while the bench is expected to move, see [`Channel::missing_below_micro`].
    pub missing_after_us: u32,
    /// The motor that is compared with its encoder, if there is one.
    pub motor: Option<MotorWatch>,
}

/// One input channel. "Micro" is a millionth of its SI unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Channel {
    /// The kind of quantity; it decides the fault when a limit is exceeded.
    pub kind: ChannelKind,
    /// Counts to SI.
    pub scale: Scale,
    /// Largest allowed magnitude.
    pub limit_micro: Option<i32>,
    /// Magnitude from which the converter is at its rail.
    pub saturation_count: Option<i16>,
    /// Longest time of one repeated count while the bench is expected to move.
    pub stuck_after_us: Option<u32>,
    /// Readings of at most this magnitude count as no signal. When they last for [`Config::missing_after_us`] while the bench is
    /// expected to move, the sensor is missing (or the shaft locked).
    pub missing_below_micro: Option<i32>,
}

/// Quantity that a channel measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ChannelKind {
    /// rad/s.
    Speed,
    /// N m.
    Torque,
    /// Anything else (V, K, ...).
    Other,
    /// A.
    Current,
    /// rad, of an encoder.
    EncoderAngle,
    /// rad/s, of an encoder.
    EncoderSpeed,
    /// N m, of a transducer that is slower than sampling, see [`crate::transducer`].
    Transducer,
}

impl ChannelKind {
    /// Whether its counts need 32 bits.
    pub fn is_wide(self) -> bool {
        matches!(self, Self::EncoderAngle | Self::EncoderSpeed | Self::Transducer)
    }

    /// Whether a speed loop can use it.
    fn is_speed(self) -> bool {
        matches!(self, Self::Speed | Self::EncoderSpeed)
    }
}

/// The command output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Output {
    /// Counts of the output converter per microvolt, in 1/2^32: see [`scaling::counts_per_uv_q32`].
    pub counts_per_uv_q32: i64,
    /// Largest magnitude ever written.
    pub clamp_uv: i32,
}

/// The speed controller: feed-forward by the motor's calibration, and in closed loop a PI controller on
/// one tachometer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpeedControl {
    /// The motor's calibration.
    pub motor: MotorLine,
    /// Index of the channel that measures the controlled speed.
    pub tachometer: u8,
    /// Proportional gain: uV per urad/s (that is V per rad/s), in 1/2^32.
    pub proportional_q32: i64,
    /// Integral gain: uV per urad/s and second, in 1/2^32.
    pub integral_per_s_q32: i64,
}

impl Channel {
    /// A channel that is sampled in counts and not watched.
    pub const UNUSED: Self = Self {
        kind: ChannelKind::Other,
        scale: Scale { micro_per_count_q16: 1 << 16, offset_micro: 0 },
        limit_micro: None,
        saturation_count: None,
        stuck_after_us: None,
        missing_below_micro: None,
    };
}

impl Default for Config {
    /// The thesis' bench at 1 kHz with 16-bit converters: input tachometer, output tachometer, input torque, output torque.
    fn default() -> Self {
        let converter = Converter::DEFAULT;
        let channel = |kind, sensor: Sensor, limit: f64| Channel {
            kind,
            scale: sensor.scale(&converter),
            limit_micro: Some(scaling::micro(limit)),
            saturation_count: Some(converter.highest_count()),
            stuck_after_us: Some(25_000),
            missing_below_micro: None,
        };
        let rpm = scaling::RAD_S_PER_RPM;
        // 1425 rpm reads 9.83 V: the highest round number below the tachometer's rail.
        let mut motor_speed = channel(ChannelKind::Speed, Sensor::MOTOR_SPEED, 1425.0 * rpm);
        let mut output_speed = channel(ChannelKind::Speed, Sensor::OUTPUT_SPEED, 1425.0 / 8.0 * 1.1 * rpm);
        // 0.5 V command 348 rpm; below 10 rpm (and an eighth of it at the output) the shafts stand still.
        motor_speed.missing_below_micro = Some(scaling::micro(10.0 * rpm));
        output_speed.missing_below_micro = Some(scaling::micro(10.0 / 8.0 * rpm));
        let mut channels = [Channel::UNUSED; MAX_CHANNELS];
        let used = [
            motor_speed,
            output_speed,
            channel(ChannelKind::Torque, Sensor::TORQUE_IN, 4.8),
            channel(ChannelKind::Torque, Sensor::TORQUE_OUT, 38.0),
        ];
        for (slot, channel) in channels.iter_mut().zip(used) {
            *slot = channel;
        }
        Self {
            sample_period_us: 1000,
            channel_count: 4,
            channels,
            output: Output { counts_per_uv_q32: scaling::counts_per_uv_q32(&converter), clamp_uv: 4_990_000 },
            speed: SpeedControl::with_gains(&MotorCalibration::LOADED, 0, 0.005, 0.1),
            host_timeout_us: 500_000,
            confirm_samples: 1,
            moving_uv: 500_000,
            missing_after_us: 500_000,
            motor: None,
        }
    }
}

impl SpeedControl {
    /// Creates the controller from its physical gains: `proportional` in V per rad/s and `integral_per_s` in V per rad/s and
    /// second, which equals V per rad.
    pub fn with_gains(
        motor: &MotorCalibration,
        tachometer: u8,
        proportional: f64,
        integral_per_s: f64,
    ) -> Self {
        let q32 = |gain: f64| (gain * 4_294_967_296.0) as i64;
        Self {
            motor: motor.line(),
            tachometer,
            proportional_q32: q32(proportional),
            integral_per_s_q32: q32(integral_per_s),
        }
    }
}

impl Config {
    /// The channels that exist.
    pub fn used_channels(&self) -> &[Channel] {
        self.channels.get(..usize::from(self.channel_count)).unwrap_or(&self.channels)
    }

    /// Number and widths of the channels.
    pub fn layout(&self) -> Layout {
        Layout::of(self.used_channels().iter().map(|channel| channel.kind.is_wide()))
    }

    /// Value of a channel, in millionths of its unit.
    pub(crate) fn value_micro<C: Count>(&self, index: u8, counts: &[C; MAX_CHANNELS]) -> i32 {
        let channel = self.channels.get(usize::from(index)).zip(counts.get(usize::from(index)));
        channel.map_or(0, |(channel, count)| channel.scale.value_micro((*count).into()))
    }

    /// The tachometer of the speed control.
    pub(crate) fn tachometer(&self) -> Option<&Channel> {
        self.used_channels().get(usize::from(self.speed.tachometer))
    }
}

impl Output {
    /// The count for a voltage, saturated.
    pub fn count(&self, voltage_uv: i32) -> i16 {
        let count = crate::fixed::scale(voltage_uv, self.counts_per_uv_q32, 32);
        count.max(i32::from(i16::MIN)).min(i32::from(i16::MAX)) as i16
    }
}

impl SpeedControl {
    /// The integral gain over one sample.
    pub(crate) fn integral_per_sample_q32(&self, sample_period_us: u32) -> i64 {
        self.integral_per_s_q32.saturating_mul(i64::from(sample_period_us)) / 1_000_000
    }
}

#[cfg(test)]
mod tests;
