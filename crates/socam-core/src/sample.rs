//! One sample of the bench, as it travels from the sampling interrupt to the host.

use crate::{MAX_CHANNELS, State};

/// Everything known about one sampling instant.
///
/// `counts` were read just before `output_count` was written: a model with zero-order hold sees `output_count` act from
/// this tick to the next, and `counts` as the bench's state at this tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// Place on the time grid since power-on: device time is `tick * sample_period_us`. Jumps where ticks were overrun;
    /// wraps after 2^32 (119 h at 10 kHz).
    pub tick: u32,
    /// Counts samples since streaming was switched on, without gaps: a gap at the receiver is a loss on the way.
    pub seq: u32,
    /// Converter readings; the entries past the configured number of channels are 0.
    pub counts: [i16; MAX_CHANNELS],
    /// Count written to the output at this tick.
    pub output_count: i16,
    /// What the profile asked for, in a millionth of V or rad/s.
    pub setpoint_micro: i32,
    /// The profile's phase: step, leg, period or sweep number, see [`crate::Setpoint::segment`].
    pub segment: u16,
    /// State of the board and remarks on this sample.
    pub flags: Flags,
}

/// The board's [`State`] at a sample, and remarks on the sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Flags(pub u8);

impl Flags {
    /// The low bits hold the state's code.
    const STATE: u8 = 0x07;
    /// A limit (slew, amplitude or output clamp) changed what the profile asked for.
    pub const LIMITED: u8 = 0x10;
    /// One or more ticks were missed just before this sample.
    pub const OVERRUN: u8 = 0x20;
    /// The converter did not answer: `counts` are not measurements.
    pub const NO_READING: u8 = 0x40;

    /// The flags of a sample taken in `state`, without remarks.
    pub fn new(state: State) -> Self {
        Self(state.code() & Self::STATE)
    }

    /// Adds `remark` where `condition` holds.
    #[must_use]
    pub fn with(self, remark: u8, condition: bool) -> Self {
        if condition { Self(self.0 | remark) } else { self }
    }

    /// Whether `remark` was made.
    pub fn has(self, remark: u8) -> bool {
        self.0 & remark != 0
    }

    /// The board's state; `None` for a code that this version does not know.
    pub fn state(self) -> Option<State> {
        State::from_code(self.0 & Self::STATE)
    }
}
