//! Status reports of a board.

use crate::{Fault, State};

/// State and counters of a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Status {
    /// State of the board.
    pub state: State,
    /// Why the output was cut, while `state` is [`State::Fault`].
    pub fault: Option<Fault>,
    /// The latest tick, see [`Sample::tick`](crate::Sample::tick).
    pub tick: u32,
    /// Ticks missed since power-on.
    pub overruns: u32,
    /// Samples lost to a full ring since power-on.
    pub dropped: u32,
    /// Samples that a limit changed since the latest run began.
    pub limited: u32,
    /// Time between two ticks.
    pub sample_period_us: u32,
    /// Whether a profile is loaded.
    pub profile_loaded: bool,
    /// Whether samples are being streamed.
    pub streaming: bool,
}
