//! Requests of a host to a board, and refusals.

use core::fmt;

use crate::{Config, ConfigError, Fault, Profile, ProfileError, State};

/// A request of the host. Each one also counts as a heartbeat.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with, and requests are rare")]
pub enum Request {
    /// Heartbeat; must be more frequent than [`Config::host_timeout_us`].
    Heartbeat,
    /// Replace the configuration and unload the profile; only when idle.
    Configure(Config),
    /// Replace the profile; only when idle.
    Load(Profile),
    /// Watch all limits and the host from now on; only when idle, with a profile.
    Arm,
    /// Enable the drive and start the profile; only when armed.
    Run,
    /// Ramp to 0 and disable the drive; disarms when armed.
    Stop,
    /// 0 V and drive disabled at once, latched as a fault.
    EmergencyStop,
    /// Back to idle after a fault.
    ClearFault,
    /// Switch the stream of samples on (`seq` restarts at 0) or off. The sender empties its ring first.
    Stream(bool),
}

/// Why a board refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Refusal {
    /// The request does not fit the state.
    WrongState {
        /// The board's state.
        state: State,
        /// The state that the request needs.
        needs: State,
    },
    /// A fault is latched; clear it first.
    Faulted(Fault),
    /// No profile is loaded.
    NoProfile,
    /// The profile is invalid.
    Profile(ProfileError),
    /// The configuration is invalid.
    Config(ConfigError),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongState { state, needs } => {
                write!(f, "the board is {state}; it must be {needs} for this")
            }
            Self::Faulted(fault) => write!(f, "a fault is latched ({fault}); clear it first"),
            Self::NoProfile => f.write_str("no profile is loaded"),
            Self::Profile(error) => write!(f, "profile refused: {error}"),
            Self::Config(error) => write!(f, "configuration refused: {error}"),
        }
    }
}

impl core::error::Error for Refusal {}

impl From<ProfileError> for Refusal {
    fn from(error: ProfileError) -> Self {
        Self::Profile(error)
    }
}

impl From<ConfigError> for Refusal {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}
