//! Recordings bound to a model.

use socam_identify::{IdentifyError, Options, Problem};
use socam_model::Model;
use socam_recording::{Dataset, RecordingError};

pub(super) fn bind<'a>(
    model: &'a Model,
    datasets: &'a [Dataset],
    options: &Options,
) -> anyhow::Result<Problem<'a>> {
    Problem::new(model, datasets, options.clone()).map_err(|error| in_words(model, error))
}

/// The error, with the remedy where the recording is one of another model.
pub(super) fn in_words(model: &Model, error: IdentifyError) -> anyhow::Error {
    match error {
        IdentifyError::Recording(error @ RecordingError::NoSuchChannel { .. }) => anyhow::anyhow!(
            "{error}; the model {} needs it (another model is chosen with --model)",
            model.name
        ),
        error => error.into(),
    }
}
