//! Why a configuration is refused.

use core::fmt;

use super::MAX_CHANNELS;
use crate::fault::Milli;

/// Why a configuration was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ConfigError {
    /// The sampling period is not 50 us to 1 s.
    SamplePeriod(u32),
    /// More channels than a board has, or none.
    ChannelCount(u8),
    /// A scale, limit or gain is zero, negative or beyond what the integers hold: this channel.
    Channel(u8),
    /// The output's scale or clamp is not positive, or the clamp exceeds the converter.
    Output,
    /// The tachometer is no channel of speed, or a gain of the speed control is negative or huge.
    SpeedControl,
    /// The host timeout is not 10 ms to 10 s.
    HostTimeout(u32),
    /// `confirm_samples` is 0, or `moving_uv` is negative.
    Watch,
    /// The motor's winding or its channels are not positive or do not exist.
    Motor,
    /// This channel is an encoder's, and the board has none.
    NoEncoder(u8),
    /// This channel is a transducer's, and the board has none there.
    NoTransducer(u8),
    /// There is a motor, and this board compares none with its encoder.
    NoMotor,
    /// No channel has anything that would end a run.
    NoLimits,
    /// The clamp exceeds what this board puts out.
    ClampCeiling {
        /// The board's ceiling.
        ceiling_uv: i32,
    },
    /// The sampling period is not one of this board.
    PeriodCeiling {
        /// The board's shortest period.
        shortest_us: u32,
        /// The board's longest period.
        longest_us: u32,
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::SamplePeriod(us) => write!(f, "sample period is {us} us; it must be 50 us to 1 s"),
            Self::ChannelCount(n) => write!(f, "{n} channels; there must be 1 to {MAX_CHANNELS}"),
            Self::Channel(i) => {
                write!(f, "channel {i}: its scale is 0 or too large, or a limit is not positive")
            }
            Self::Output => {
                f.write_str("the output's scale or clamp is not positive, or the clamp exceeds the converter")
            }
            Self::SpeedControl => f.write_str(
                "speed control: the tachometer is not a speed channel, or a gain is negative or too large",
            ),
            Self::HostTimeout(us) => write!(f, "host timeout is {us} us; it must be 10 ms to 10 s"),
            Self::Watch => f.write_str("confirm_samples must be at least 1 and moving_uv at least 0"),
            Self::Motor => f.write_str(
                "the motor's resistance, back-EMF and times must be positive, and its speed, current, voltage and supply channels must exist",
            ),
            Self::NoEncoder(i) => {
                write!(f, "channel {i} is an encoder's, and this board has no encoders: give a calibration for this board")
            }
            Self::NoTransducer(i) => {
                write!(f, "channel {i} is a torque transducer's, and this board has none there: give a calibration for this board")
            }
            Self::NoMotor => {
                f.write_str("this board cannot compare a motor with its encoder: give a calibration for this board")
            }
            Self::NoLimits => f.write_str(
                "no channel has a limit, a rail or a test of its sensor, so nothing would stop the bench: give one channel a `limit`",
            ),
            Self::ClampCeiling { ceiling_uv } => {
                write!(f, "the output's clamp exceeds the {} V that this board puts out", Milli(ceiling_uv))
            }
            Self::PeriodCeiling { shortest_us, longest_us } => {
                write!(f, "this board's sample period is {shortest_us} us to {longest_us} us")
            }
        }
    }
}

impl core::error::Error for ConfigError {}
