//! Why a profile is refused.

use core::fmt;

use super::shape::MAX_LINES;
use crate::fault::Milli;

/// Why a profile was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ProfileError {
    /// A limit, a slew rate or a duration is zero or negative.
    NotPositive(ProfileKey),
    /// The shape exceeds the profile's own limit.
    OverLimit {
        /// Largest magnitude of the shape.
        peak_micro: i64,
        /// The limit.
        limit_micro: i32,
    },
    /// The slew limit moves less than one millionth per sample.
    SlewTooSlow,
    /// A time is not a whole number of samples, or less than the minimum.
    NotWholeSamples {
        /// The parameter.
        key: ProfileKey,
        /// The time.
        time_us: u32,
        /// The sampling period.
        sample_period_us: u32,
        /// Fewest samples.
        at_least: u32,
    },
    /// A frequency is zero, or not below half the sampling rate.
    Frequency {
        /// The frequency.
        frequency_uhz: u64,
    },
    /// A sequence order outside 3 to 16.
    Order(u8),
    /// No line, or more than [`MAX_LINES`].
    LineCount(u32),
    /// The profile with its ramp lasts longer than this board allows.
    DurationCeiling {
        /// The board's ceiling.
        ceiling_us: u64,
    },
    /// The profile's limit exceeds the speed that this board commands.
    SpeedCeiling {
        /// The board's ceiling.
        ceiling_urad_s: i32,
    },
}

/// Names a parameter of a profile in a [`ProfileError`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[expect(missing_docs, reason = "each is the parameter of that name")]
pub enum ProfileKey {
    Limit,
    Slew,
    Duration,
    Count,
    Dwell,
    Period,
    Periods,
    Sweep,
    Bit,
}

impl fmt::Display for ProfileKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Limit => "limit",
            Self::Slew => "slew",
            Self::Duration => "duration",
            Self::Count => "count",
            Self::Dwell => "dwell",
            Self::Period => "period",
            Self::Periods => "periods",
            Self::Sweep => "sweep",
            Self::Bit => "bit",
        })
    }
}

impl fmt::Display for ProfileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotPositive(key) => write!(f, "{key} must be greater than 0"),
            Self::OverLimit { peak_micro, limit_micro } => write!(
                f,
                "the command reaches {peak_micro} millionths, its limit is {limit_micro}: lower the amplitude or raise the limit"
            ),
            Self::SlewTooSlow => f.write_str("slew is less than one millionth per sample: raise it"),
            Self::NotWholeSamples { key, time_us, sample_period_us, at_least } => write!(
                f,
                "{key} is {time_us} us; it must be a whole number of samples of {sample_period_us} us, at least {at_least}"
            ),
            Self::Frequency { frequency_uhz } => {
                write!(
                    f,
                    "a frequency of {frequency_uhz} uHz must be above 0 and below half the sampling rate"
                )
            }
            Self::Order(order) => write!(f, "order is {order}; it must be 3 to 16"),
            Self::LineCount(count) => write!(f, "{count} lines; there must be 1 to {MAX_LINES}"),
            Self::DurationCeiling { ceiling_us } => {
                write!(f, "it lasts longer than the {} s that this board runs", ceiling_us / 1_000_000)
            }
            Self::SpeedCeiling { ceiling_urad_s } => {
                write!(f, "its limit exceeds the {} rad/s that this board commands", Milli(ceiling_urad_s))
            }
        }
    }
}

impl core::error::Error for ProfileError {}
