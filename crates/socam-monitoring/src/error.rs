//! Input that a monitor cannot use.

use socam_identify::IdentifyError;
use socam_recording::RecordingError;
use thiserror::Error;

/// Input that a monitor cannot use.
#[derive(Debug, Error)]
pub enum MonitorError {
    /// The model cannot be evaluated on these samples.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// A recording could not be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A setting is out of its range.
    #[error("{0}")]
    Setting(String),
    /// The model cannot be monitored block by block.
    #[error("the model {model} cannot be watched: {why}")]
    Unsuited {
        /// Name of the model.
        model: String,
        /// Reason, and what to do.
        why: String,
    },
    /// The model reads a column that the recording lacks.
    #[error("the model {model} reads {column}, which is not among the columns watched: {held}")]
    Channel {
        /// Name of the model.
        model: String,
        /// Column that is missing.
        column: String,
        /// Columns that are there.
        held: String,
    },
    /// The healthy recordings hold too few blocks that can be used.
    #[error(
        "the healthy recordings hold {usable} usable blocks of {block_s} s, but at least {needed} are needed: \
         record the healthy bench for {needed_s:.0} s or longer"
    )]
    TooShort {
        /// Blocks that can be used.
        usable: usize,
        /// Length of a block, s.
        block_s: f64,
        /// Least number of blocks.
        needed: usize,
        /// Their length together, s.
        needed_s: f64,
    },
    /// The samples come at another rate than those of the healthy recordings.
    #[error(
        "the samples are {found_s:.6} s apart, those of the baseline {expected_s:.6} s: record the baseline at the rate that is watched"
    )]
    Rate {
        /// Sample time of the monitored samples, s.
        found_s: f64,
        /// Sample time of the baseline, s.
        expected_s: f64,
    },
}
