//! Errors of the efficiency measurement.

/// One sentence: what, where, what was expected, what to do.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each message says what its fields are")]
pub enum EfficiencyError {
    #[error("the model {model} has no section whose losses could be measured: {why}")]
    Model { model: String, why: String },
    #[error(
        "{windows} usable averaging windows do not determine losses; record at least a few seconds in motion"
    )]
    TooFew { windows: usize },
    #[error(transparent)]
    Recording(#[from] socam_recording::RecordingError),
}
