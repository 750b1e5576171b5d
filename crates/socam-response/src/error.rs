//! Why there is no response.

use socam_frequency::FrequencyError;
use socam_model::ModelError;
use socam_recording::RecordingError;
use thiserror::Error;

/// Why recordings and a model give no frequency response.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ResponseError {
    /// A model with several inputs, or none.
    #[error(
        "the model {model} has the inputs {inputs}; a frequency response is of one input, so give a model with one"
    )]
    Inputs {
        /// Name of the model.
        model: String,
        /// Names of its inputs.
        inputs: String,
    },
    /// An output that the model does not have.
    #[error("output {name}: the model {model} has the outputs {outputs}")]
    UnknownOutput {
        /// The name that was asked for.
        name: String,
        /// Name of the model.
        model: String,
        /// Names of its outputs.
        outputs: String,
    },
    /// A channel whose values are no linear function of its column.
    #[error(
        "the channel {channel} takes a wave of its column, which has no frequency response; fit the output error instead"
    )]
    Wave {
        /// Name of the channel.
        channel: String,
    },
    /// A recording that cannot be read, or lacks a channel.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A model without equations of motion.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Signals from which no response can be estimated.
    #[error(transparent)]
    Frequency(#[from] FrequencyError),
}

/// Result of this crate.
pub type Result<T> = std::result::Result<T, ResponseError>;
