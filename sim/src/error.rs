//! Errors of a simulation.

use socam_model::ModelError;

/// Why a simulation cannot start or continue, in one sentence.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// The model refuses its parameters or has no unique motion.
    #[error("the simulated drivetrain cannot move: {0}")]
    Model(#[from] ModelError),
    /// The solver gave up.
    #[error("the simulation failed at {time_s:.4} s: {reason}; a parameter far out of proportion does that")]
    Solver {
        /// Simulated time reached.
        time_s: f64,
        /// The solver's message.
        reason: String,
    },
    /// The recording that drives the simulation cannot be read.
    #[error(transparent)]
    Recording(#[from] socam_recording::RecordingError),
    /// The bench's calibration is invalid.
    #[error(transparent)]
    Settings(#[from] socam_recording::SettingsError),
    /// The board refused the calibration or the profile.
    #[error(transparent)]
    Refused(#[from] socam_core::Refusal),
    /// The board ended the run before the profile's end.
    #[error("the board ended the run at {time_s:.3} s: {reason}")]
    Fault {
        /// Time since the start of the profile.
        time_s: f64,
        /// The fault in words.
        reason: String,
    },
    /// An argument names something that does not exist, or cannot be parsed.
    #[error("`{text}`: {problem}")]
    Argument {
        /// The text.
        text: String,
        /// Explanation: what is wrong with it, and what was expected.
        problem: String,
    },
}

impl SimError {
    pub(crate) fn argument(text: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Argument { text: text.into(), problem: problem.into() }
    }
}
