//! The board's states.

use core::fmt;

/// State of the board. The output is live in `Running` and `Stopping` and nowhere else.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum State {
    /// 0 V, drive disabled; may be configured.
    Idle,
    /// 0 V, drive disabled; all limits and the host are watched.
    Armed,
    /// The drive is enabled and follows the profile.
    Running,
    /// The drive is enabled and ramps to 0.
    Stopping,
    /// 0 V, drive disabled, until the fault is cleared.
    Fault,
}

impl State {
    /// Number of the state, the same in all versions.
    pub fn code(self) -> u8 {
        match self {
            Self::Idle => 0,
            Self::Armed => 1,
            Self::Running => 2,
            Self::Stopping => 3,
            Self::Fault => 4,
        }
    }

    /// The state with this code.
    pub fn from_code(code: u8) -> Option<Self> {
        [Self::Idle, Self::Armed, Self::Running, Self::Stopping, Self::Fault]
            .into_iter()
            .find(|state| state.code() == code)
    }

    /// Whether the drive is enabled.
    pub fn is_live(self) -> bool {
        matches!(self, Self::Running | Self::Stopping)
    }

    /// Whether limits and the host are watched.
    pub(crate) fn is_watched(self) -> bool {
        matches!(self, Self::Armed | Self::Running | Self::Stopping)
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Idle => "idle",
            Self::Armed => "armed",
            Self::Running => "running",
            Self::Stopping => "stopping",
            Self::Fault => "in fault",
        })
    }
}
