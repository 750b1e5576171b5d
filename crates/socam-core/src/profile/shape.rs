//! A profile as plain data.

/// A command over time with its limits. It begins and ends at 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Profile {
    /// The commanded quantity.
    pub command: Command,
    /// The command over time.
    pub shape: Shape,
    /// Time of the fade from 0 at the start, and to 0 at the end or when stopped. A profile with fast parts needs it: its slew limit
    /// cannot be low enough for a soft start.
    pub ramp_us: u32,
    /// Largest magnitude.
    pub limit_micro: i32,
    /// Largest rate of change, per second.
    pub slew_micro_s: u32,
    /// Time until the profile ends by itself, fade-in included, fade-out not.
    pub duration_us: u64,
}

/// Longest time after its planned end that a run is given, for ticks that were missed.
const LATE_US: u64 = 1_000_000;

impl Profile {
    /// Longest time of a run by the clock, whatever its ticks do: duration, fade and the slew to 0, and some time for missed ticks.
    pub(crate) fn longest_us(&self) -> u64 {
        let slew_us = u64::from(self.limit_micro.unsigned_abs())
            .wrapping_mul(1_000_000)
            .checked_div(u64::from(self.slew_micro_s))
            .unwrap_or(0);
        [u64::from(self.ramp_us), slew_us, LATE_US].into_iter().fold(self.duration_us, u64::saturating_add)
    }
}

/// The quantity that a profile commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Output voltage, in uV.
    Voltage,
    /// Motor speed in urad/s, by the motor's calibration alone.
    SpeedOpenLoop,
    /// Motor speed in urad/s, by the motor's calibration and a PI controller on the tachometer.
    SpeedClosedLoop,
}

/// The shape of a profile over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shape {
    /// One level.
    Constant {
        /// The level.
        level_micro: i32,
    },
    /// Levels in sequence, repeated.
    Staircase {
        /// The first level.
        first_micro: i32,
        /// Difference from one level to the next.
        step_micro: i32,
        /// Number of levels; at least 1.
        count: u16,
        /// Time at each level.
        dwell_us: u32,
        /// Returns through the same levels instead of jumping to the first.
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
        /// The profile ends after this many periods (the thesis' program: 10), or with its duration.
        periods: Option<u16>,
    },
    /// Linear from 0 to +amplitude, to -amplitude, and back to 0, around an offset.
    Triangle {
        /// Mean.
        offset_micro: i32,
        /// Peak.
        amplitude_micro: i32,
        /// Period; a whole number of samples.
        period_us: u32,
    },
    /// A sine whose frequency changes by the same factor in equal times (logarithmic sweep), repeated.
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
        /// Half the distance of the two levels.
        amplitude_micro: i32,
        /// Time of one bit; a whole number of samples.
        bit_us: u32,
        /// The sequence repeats after 2^order - 1 bits; 3 to 16.
        order: u8,
        /// Start of the sequence: the initial shift register.
        seed: u16,
    },
    /// A periodic sum of sines of equal amplitude with random phases.
    Multisine {
        /// Mean.
        offset_micro: i32,
        /// Peak of each single line. The peak of the sum depends on the phases: [`Generator::peak_micro`](crate::Generator::peak_micro) computes it.
        line_micro: i32,
        /// Period, the inverse of the line spacing; a whole number of samples.
        period_us: u32,
        /// The multiples of the spacing that are lines.
        lines: Lines,
        /// First line, as a multiple of the spacing; at least 1.
        first_line: u16,
        /// Last line, as a multiple of the spacing.
        last_line: u16,
        /// Seed of the phases.
        seed: u32,
    },
}

/// Most lines of a multisine: what the sum's integer format holds.
pub const MAX_LINES: u32 = 256;

/// Multiples of the line spacing that a multisine contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Lines {
    /// All of them.
    Full,
    /// Odd multiples: even-order nonlinearity shows up between them.
    Odd,
    /// Even multiples.
    Even,
}
