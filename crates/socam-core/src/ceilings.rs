//! Limits that a board never exceeds, whatever its configuration and profile ask for.

/// The limits of a board's program. They are constants of the program, so that no message and no flipped bit of memory changes them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ceilings {
    /// Largest magnitude of the output, and of a configuration's clamp.
    pub output_uv: i32,
    /// Largest limit of a profile that commands speed.
    pub speed_urad_s: i32,
    /// Longest time from the enabling of the drive to its end.
    pub run_us: u64,
    /// Shortest time between two ticks.
    pub shortest_period_us: u32,
    /// Longest time between two ticks.
    pub longest_period_us: u32,
}

impl Ceilings {
    /// The largest limits that the integers of this crate can hold, for a board with no bench attached that could be damaged.
    pub const WIDEST: Self = Self {
        output_uv: i32::MAX,
        speed_urad_s: i32::MAX,
        run_us: u64::MAX,
        shortest_period_us: 50,
        longest_period_us: 1_000_000,
    };
}
