//! Command profiles: a few parameters that become the same samples on board and host.
//!
//! Integers only. A [`Profile`] is plain data; a [`Generator`] holds where it stands. "Micro" is a millionth of V or rad/s,
//! as [`Profile::command`] says.

mod chirp;
mod generator;
mod multisine;
mod prbs;
mod sine;
mod staircase;
mod triangle;

use core::fmt;

pub use generator::{Generator, Setpoint};
pub use multisine::{Lines, MAX_LINES};

/// What to command, for how long, within which limits. It begins and ends at 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Profile {
    /// What the values mean.
    pub command: Command,
    /// The course over time.
    pub shape: Shape,
    /// Time over which the whole course fades in from 0 and, at the end or when stopped, out to 0. A profile with fast parts
    /// needs it: its slew limit cannot be low enough for a soft start.
    pub ramp_us: u32,
    /// Largest magnitude.
    pub limit_micro: i32,
    /// Largest rate of change, per second.
    pub slew_micro_s: u32,
    /// Time until the profile ends by itself, fade-in included, fade-out not.
    pub duration_us: u64,
}

/// What a profile's values mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Output voltage, in uV.
    Voltage,
    /// Motor speed in urad/s, by the motor's calibration alone.
    SpeedOpenLoop,
    /// Motor speed in urad/s, by the motor's calibration and a PI controller on the tachometer.
    SpeedClosedLoop,
}

/// The course of a profile over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shape {
    /// One level.
    Constant {
        /// The level.
        level_micro: i32,
    },
    /// Levels one after the other, again and again.
    Staircase {
        /// The first level.
        first_micro: i32,
        /// From one level to the next.
        step_micro: i32,
        /// Number of levels; at least 1.
        count: u16,
        /// Time on each level.
        dwell_us: u32,
        /// Back down the same levels, instead of starting over.
        and_back: bool,
    },
    /// A sine around an offset: the thesis' program.
    Sine {
        /// Mean.
        offset_micro: i32,
        /// Peak.
        amplitude_micro: i32,
        /// Frequency.
        frequency_uhz: u32,
        /// The profile ends after so many periods (the thesis' program: 10), or with its duration.
        periods: Option<u16>,
    },
    /// Straight from 0 to +amplitude, through zero to -amplitude, and back to 0, around an offset.
    Triangle {
        /// Mean.
        offset_micro: i32,
        /// Peak.
        amplitude_micro: i32,
        /// Time of one such course; a whole number of samples.
        period_us: u32,
    },
    /// A sine whose frequency grows (or falls) by the same factor in equal times, again and again.
    Chirp {
        /// Mean.
        offset_micro: i32,
        /// Peak.
        amplitude_micro: i32,
        /// Frequency at the start of a sweep.
        start_uhz: u32,
        /// Frequency at the end of a sweep.
        end_uhz: u32,
        /// Time of one sweep.
        sweep_us: u32,
    },
    /// A pseudo-random binary sequence of maximum length.
    Prbs {
        /// Mean.
        offset_micro: i32,
        /// Distance of both levels from the mean.
        amplitude_micro: i32,
        /// Shortest time on a level; a whole number of samples.
        bit_us: u32,
        /// The sequence repeats after 2^order - 1 bits; 3 to 16.
        order: u8,
        /// Where the sequence starts.
        seed: u16,
    },
    /// A periodic sum of equally strong sines with random phases.
    Multisine {
        /// Mean.
        offset_micro: i32,
        /// Peak of each single line. The peak of the sum depends on the phases: [`Generator::peak_micro`] finds it.
        line_micro: i32,
        /// Time of one period, whose inverse is the line spacing; a whole number of samples.
        period_us: u32,
        /// Which multiples of the spacing.
        lines: Lines,
        /// First line, as a multiple of the spacing; at least 1.
        first_line: u16,
        /// No line lies above this multiple.
        last_line: u16,
        /// Draws the phases.
        seed: u32,
    },
}

/// Why a profile was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ProfileError {
    /// A limit, a slew rate or a duration is zero or negative.
    NotPositive(ProfileKey),
    /// The course exceeds the profile's own limit.
    OverLimit {
        /// Largest magnitude of the course.
        peak_micro: i64,
        /// The limit.
        limit_micro: i32,
    },
    /// The slew limit moves less than one millionth per sample.
    SlewTooSlow,
    /// A time is not a whole number of samples, or is less than the fewest that make sense.
    NotWholeSamples {
        /// Which time.
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
                "the course reaches {peak_micro} millionths, its limit is {limit_micro}: lower the amplitude or raise the limit"
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
        }
    }
}

impl core::error::Error for ProfileError {}

/// `time_us` as a whole number of samples, at least `at_least`.
fn whole_samples(
    key: ProfileKey,
    time_us: u32,
    sample_period_us: u32,
    at_least: u32,
) -> Result<u32, ProfileError> {
    let error = ProfileError::NotWholeSamples { key, time_us, sample_period_us, at_least };
    let samples = time_us.checked_div(sample_period_us).ok_or(error)?;
    let is_whole = samples.wrapping_mul(sample_period_us) == time_us;
    if is_whole && samples >= at_least { Ok(samples) } else { Err(error) }
}

/// Whether a sine of this frequency can be sampled at this period.
fn check_frequency(frequency_uhz: u64, sample_period_us: u32) -> Result<(), ProfileError> {
    let half_turns_e12 = frequency_uhz.saturating_mul(u64::from(sample_period_us)).saturating_mul(2);
    if frequency_uhz > 0 && half_turns_e12 < 1_000_000_000_000 {
        Ok(())
    } else {
        Err(ProfileError::Frequency { frequency_uhz })
    }
}

/// Runs through one turn of 2^32 in exactly `period` samples: the position is floor(n * 2^32 / period), without a division
/// per sample and without drift.
#[derive(Debug, Clone, Copy)]
struct PeriodClock {
    phase: u32,
    /// The fraction that `phase` leaves out, in 1/`period`.
    rest: u32,
    phase_step: u32,
    rest_step: u32,
    period: u32,
    periods: u16,
}

impl PeriodClock {
    /// `period` is at least 2.
    fn new(period: u32) -> Self {
        let turn = 1u64 << 32;
        let divisor = u64::from(period.max(2));
        Self {
            phase: 0,
            rest: 0,
            phase_step: turn.checked_div(divisor).unwrap_or(0) as u32,
            rest_step: turn.checked_rem(divisor).unwrap_or(0) as u32,
            period: period.max(2),
            periods: 0,
        }
    }

    /// The position at this sample.
    fn step(&mut self) -> u32 {
        let phase = self.phase;
        // Both are below `period` <= 2^32 - 1; u64 keeps their sum.
        let rest = u64::from(self.rest).wrapping_add(u64::from(self.rest_step));
        let carry = rest >= u64::from(self.period);
        self.rest = if carry { rest.wrapping_sub(u64::from(self.period)) } else { rest } as u32;
        // phase_step < 2^31, so neither addition can wrap before the turn is full.
        let (next, wrapped) = phase.overflowing_add(self.phase_step.wrapping_add(u32::from(carry)));
        self.phase = next;
        self.periods = self.periods.wrapping_add(u16::from(wrapped));
        phase
    }
}

#[cfg(test)]
mod tests;
