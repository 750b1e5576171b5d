//! Errors of an identification: input that cannot be used. Outcomes (not converged, not determined) are values of the result and not
//! errors.

use socam_model::ModelError;
use socam_recording::RecordingError;
use thiserror::Error;

/// Input that cannot be used.
#[derive(Debug, Error)]
pub enum IdentifyError {
    /// A recording could not be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The model's equations could not be formed.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No recording was given.
    #[error("no recording was given; name at least one")]
    NoRecordings,
    /// A recording is too short for the model.
    #[error(
        "{recording}: its longest segment without gaps has {rows} samples, but at least {needed} are needed"
    )]
    TooShort {
        /// Recording name.
        recording: String,
        /// Samples of its longest segment.
        rows: u64,
        /// Least number of samples.
        needed: u64,
    },
    /// A parameter that was named does not exist.
    #[error("the model {model} has no parameter \"{name}\"; its parameters are {known}")]
    NoSuchParameter {
        /// Model name.
        model: String,
        /// The name that was given.
        name: String,
        /// Names of all parameters.
        known: String,
    },
    /// All parameters are fixed, and the task is about free ones.
    #[error("every parameter of the model {model} is fixed; free at least one")]
    NothingFree {
        /// Model name.
        model: String,
    },
    /// A model that would be fitted for minutes.
    #[error(
        "the model {model} has {nodes} nodes and {free} free parameters; at most {most_nodes} and {most_free} are fitted: lump nodes, or fix parameters"
    )]
    TooLarge {
        /// Model name.
        model: String,
        /// Number of nodes of the model.
        nodes: usize,
        /// Number of free parameters of the model.
        free: usize,
        /// Most nodes.
        most_nodes: usize,
        /// Most free parameters.
        most_free: usize,
    },
    /// A free parameter starts outside its bounds.
    #[error("{name} starts at {value}, outside its bounds {low} to {high}; fix it there, or move its bounds")]
    StartOutOfBounds {
        /// Parameter name.
        name: String,
        /// Start value, SI.
        value: f64,
        /// Lower bound, SI.
        low: f64,
        /// Upper bound, SI.
        high: f64,
    },
    /// An option that contradicts the model.
    #[error("{0}")]
    Option(String),
    /// The method does not suit the model.
    #[error("{method} does not suit the model {model}: {why}")]
    Unsuited {
        /// Method name.
        method: &'static str,
        /// Model name.
        model: String,
        /// Reason and remedy.
        why: String,
    },
    /// The prediction overflowed at the start values.
    #[error(
        "the model {model} runs away on these data at its start values; check signs and units of its parameters"
    )]
    Diverged {
        /// Model name.
        model: String,
    },
    /// The observer cancelled the work.
    #[error("cancelled")]
    Cancelled,
}
