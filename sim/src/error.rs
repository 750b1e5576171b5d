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
