//! One sample of the bench, as it travels from the sampling interrupt to the host.

use crate::{MAX_CHANNELS, State};

/// Inputs, output and state at one sampling instant.
///
/// `counts` were read just before `output_count` was written: `output_count` acts from this tick to the next
/// (zero-order hold), and `counts` are the bench's state at this tick. `C` is the board's [`crate::Count`]; a host takes both in 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample<C = i32> {
    /// Number of the tick since power-on: device time is `tick * sample_period_us`. Jumps where ticks were overrun;
    /// wraps after 2^32 (119 h at 10 kHz).
    pub tick: u32,
    /// Counts samples since streaming was switched on, without gaps: a gap at the receiver is a loss on the way.
    pub seq: u32,
    /// Readings of converters and encoders; the entries past the configured number of channels are 0.
    pub counts: [C; MAX_CHANNELS],
    /// Count written to the output at this tick.
    pub output_count: i16,
    /// The profile's setpoint, in a millionth of V or rad/s.
    pub setpoint_micro: i32,
    /// Number of the profile's part: level, half period, period or sweep, see [`crate::Setpoint::segment`].
    pub segment: u16,
    /// State of the board and flags of this sample.
    pub flags: Flags,
}

/// The board's [`State`] at a sample, and flags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Flags(pub u8);

impl Flags {
    /// The low bits hold the state's code.
    const STATE: u8 = 0x07;
    /// A limit (slew, amplitude or output clamp) changed the setpoint.
    pub const LIMITED: u8 = 0x10;
    /// One or more ticks were missed just before this sample.
    pub const OVERRUN: u8 = 0x20;
    /// The first and the second digital input were high at, or since, the sample before.
    pub const INPUTS: [u8; 2] = [0x08, 0x80];
    /// The converter did not answer: `counts` are not measurements.
    pub const NO_READING: u8 = 0x40;

    /// The flags of a sample in `state`, none set.
    pub fn new(state: State) -> Self {
        Self(state.code() & Self::STATE)
    }

    /// Sets a flag where `condition` holds.
    #[must_use]
    pub fn with(self, flag: u8, condition: bool) -> Self {
        if condition { Self(self.0 | flag) } else { self }
    }

    /// Whether a flag is set.
    pub fn has(self, flag: u8) -> bool {
        self.0 & flag != 0
    }

    /// The board's state; `None` for a code that this version does not know.
    pub fn state(self) -> Option<State> {
        State::from_code(self.0 & Self::STATE)
    }
}
