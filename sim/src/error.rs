//! What can go wrong in a simulation.

use socam_model::ModelError;

/// A simulation that cannot begin or go on, in one sentence.
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
        /// The solver's words.
        reason: String,
    },
    /// The recording that drives the simulation cannot be read.
    #[error(transparent)]
    Recording(#[from] socam_recording::RecordingError),
    /// The bench's calibration is not sound.
    #[error(transparent)]
    Settings(#[from] socam_recording::SettingsError),
    /// The board did not take the bench's settings or the profile.
    #[error(transparent)]
    Refused(#[from] socam_core::Refusal),
    /// The board ended the run before the profile's end.
    #[error("the board ended the run at {time_s:.3} s: {reason}")]
    Fault {
        /// Time since the course began.
        time_s: f64,
        /// The fault in words.
        reason: String,
    },
    /// Something that was asked for in words does not exist or cannot be understood.
    #[error("`{text}`: {problem}")]
    Argument {
        /// The text.
        text: String,
        /// What is wrong with it, and what was expected.
        problem: String,
    },
}

impl SimError {
    pub(crate) fn argument(text: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Argument { text: text.into(), problem: problem.into() }
    }
}
