//! `simulate`: the virtual bench on a profile, and a model driven by a recording's inputs.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use socam_job::{JobError, Simulate};
use socam_recording::ProfileFile;

use crate::errors::Raised;
use crate::model::Model;
use crate::options::settings;
use crate::recording::Recording;
use crate::waiting;

/// Names of the built-in profiles.
#[pyfunction]
pub(crate) fn profiles() -> Vec<&'static str> {
    ProfileFile::built_in_names().collect()
}

/// Records a profile (its name, or the text of a profile file) on the virtual bench of a model.
#[pyfunction]
#[pyo3(signature = (model, profile, *, name, **options: "object"))]
pub(crate) fn simulate(
    py: Python<'_>,
    model: &Model,
    profile: &str,
    name: String,
    options: Option<Bound<'_, PyDict>>,
) -> PyResult<Recording> {
    let task: Simulate = settings(options.as_ref())?;
    let file = ProfileFile::parse(ProfileFile::built_in_text(profile).unwrap_or(profile));
    let file = file.map_err(|error| JobError::from(error).raised())?;
    let model = model.0.clone();
    let data = waiting::run(py, None, move |_| task.run(&model, file, name))?;
    Ok(Recording::new(data.map_err(Raised::raised)?))
}

/// Drives a model by the inputs of a recording. Returns the simulated recording, and its errors as the document `socam.comparison/1`.
#[pyfunction]
#[pyo3(signature = (model, inputs, **options: "object"))]
pub(crate) fn replay(
    py: Python<'_>,
    model: &Model,
    inputs: Py<Recording>,
    options: Option<Bound<'_, PyDict>>,
) -> PyResult<(Recording, String)> {
    let task: Simulate = settings(options.as_ref())?;
    let (model, data) = (model.0.clone(), inputs.get().data.clone());
    let done = waiting::run(py, None, move |_| task.replay(&model, |grid| Ok(grid.apply(data)?)))?;
    let (_, done) = done.map_err(Raised::raised)?;
    let document = serde_json::to_string(&done.document).map_err(Raised::raised)?;
    Ok((Recording::new(done.simulated), document))
}
