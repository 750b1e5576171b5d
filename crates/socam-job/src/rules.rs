//! Rules that several tasks share.

use socam_identify::StartState;

use crate::error::{JobError, Result};

/// Refuses a rate of false alarms or discoveries that is not between 0 and 1.
///
/// # Errors
/// [`JobError::Value`] of the option with this keyword and flag.
pub fn check_rate(keyword: &str, flag: &str, rate: f64) -> Result<()> {
    if rate > 0.0 && rate < 1.0 {
        return Ok(());
    }
    Err(JobError::value(keyword, flag, format!(" {rate}: expected a number between 0 and 1")))
}

/// Like [`check_rate`], for the option `--false-alarm-rate`.
///
/// # Errors
/// As [`check_rate`].
pub fn check_false_alarm_rate(rate: f64) -> Result<()> {
    check_rate("false_alarm_rate", "--false-alarm-rate", rate)
}

/// State in which the simulation of each recording starts
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Start {
    /// An unknown state, which is estimated
    Free,
    /// Equilibrium at the first input sample
    Equilibrium,
}

impl Start {
    /// The state in the form of the library.
    #[must_use]
    pub fn state(self) -> StartState {
        match self {
            Self::Free => StartState::Free,
            Self::Equilibrium => StartState::Equilibrium,
        }
    }
}
