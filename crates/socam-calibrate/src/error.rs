//! Why a calibration cannot be made.

/// One sentence: what, where, what was expected, what to do.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each message says what its fields are")]
pub enum CalibrateError {
    #[error("cannot read `{file}`: {problem}")]
    Read { file: String, problem: String },
    #[error("`{file}`, line {line}: {problem}")]
    Line { file: String, line: u64, problem: String },
    #[error("`{file}`: {problem}")]
    File { file: String, problem: String },
    #[error("{what}: {rows} usable points do not determine a line; measure at least 4 different ones")]
    TooFew { what: String, rows: usize },
    #[error("{what}: all points have the same {over}; spread them over the range in use")]
    NoSpread { what: String, over: String },
    #[error(transparent)]
    Recording(#[from] socam_recording::RecordingError),
}
