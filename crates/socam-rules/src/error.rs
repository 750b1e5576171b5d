//! Errors of rules.

use socam_recording::{RecordingError, SettingsError};

/// Why rules cannot be read, or cannot be applied to a recording.
#[derive(Debug, thiserror::Error)]
pub enum RulesError {
    /// A mistake in the file.
    #[error(transparent)]
    File(#[from] SettingsError),
    /// A rule that does not go with the channels of a recording.
    #[error("line {line}: rules.{rule}.{problem}")]
    Unfit {
        /// Line of the formula.
        line: usize,
        /// Name of the rule.
        rule: String,
        /// What is wrong with which key, and what to do.
        problem: String,
    },
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
}
