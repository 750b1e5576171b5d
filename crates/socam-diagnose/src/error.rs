//! Why a diagnosis cannot be made.

use socam_identify::IdentifyError;
use socam_model::ModelError;
use socam_recording::RecordingError;
use thiserror::Error;

/// Input that a diagnosis cannot use.
#[derive(Debug, Error)]
pub enum DiagnoseError {
    /// The base model could not be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// A recording could not be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The corrected model could not be written.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A recording is both held out and fitted.
    #[error(
        "`{holdout}` holds the same samples as `{training}`; what is held out must not be fitted: hold out another recording"
    )]
    SameSamples {
        /// Name of the recording that is held out.
        holdout: String,
        /// Name of the recording that is fitted.
        training: String,
    },
    /// A channel is constant in all recordings that are fitted.
    #[error(
        "{channel} never changes in any recording that is fitted, although others do: is its sensor connected? To do without it, take \
         it out of the model's channels"
    )]
    Disconnected {
        /// Name of the channel.
        channel: String,
    },
    /// The base model's prediction overflows.
    #[error(
        "{model} cannot follow these recordings: its prediction overflows; give start values nearer to the bench"
    )]
    Diverged {
        /// Name of the model.
        model: String,
    },
}

impl DiagnoseError {
    /// Error for a held-out recording with the samples of a fitted one, both given by name.
    pub(crate) fn same_samples(held_out: &str, training: &str) -> Self {
        Self::SameSamples { holdout: held_out.to_owned(), training: training.to_owned() }
    }
}
