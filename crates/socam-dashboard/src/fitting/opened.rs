//! Recordings in full precision, as a fit takes them.

use socam_model::Model;
use socam_recording::Dataset;

use crate::job::Handle;
use crate::recording::{Recording, short};

/// Reads recordings again for a fit of `model`; irregular samples are put on a grid of `parts` points a sample.
///
/// # Errors
/// When one cannot be read, or the job was cancelled; one sentence.
pub(crate) fn datasets(
    recordings: &[Recording],
    model: &Model,
    parts: u32,
    handle: &Handle,
) -> Result<Vec<Dataset>, String> {
    let one = |recording: &Recording| {
        handle.doing(format!("reading {}", short(&recording.about.name)));
        handle.reached(0.0)?;
        dataset(recording, model, parts)
    };
    recordings.iter().map(one).collect()
}

/// Reads one recording again, as [`datasets`] does.
///
/// # Errors
/// When it cannot be read; one sentence.
pub(crate) fn dataset(recording: &Recording, model: &Model, parts: u32) -> Result<Dataset, String> {
    let data = recording.dataset()?;
    socam_expectation::on_regular_grid(data, model, parts).map_err(|error| error.to_string())
}
