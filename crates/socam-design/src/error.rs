//! Errors of the experiment design.

/// One sentence: what, where, what was expected, what to do.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each message says what its fields are")]
pub enum DesignError {
    #[error("no profile runs within these limits; the last one that was tried: {last}")]
    NothingRuns { last: String },
    #[error(
        "no profile within these limits determines anything of {model}; allow more voltage, speed or time"
    )]
    NothingShows { model: String },
    #[error("{what} is {value}; expected {expected}")]
    Limit { what: &'static str, value: f64, expected: &'static str },
    #[error(transparent)]
    Identify(#[from] socam_identify::IdentifyError),
    #[error(transparent)]
    Sim(#[from] socam_sim::SimError),
    #[error(transparent)]
    Recording(#[from] socam_recording::RecordingError),
}
