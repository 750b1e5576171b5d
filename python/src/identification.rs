//! `identify`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use socam_job::{Grid, Identified, Identify, JobError};

use crate::errors::Raised;
use crate::model::Model;
use crate::options::settings;
use crate::recording::{self, Recording, all};
use crate::waiting;

/// The result of a fit.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct Identification(Identified);

#[pymethods]
impl Identification {
    /// The document `socam.identification/1`, as `socam-host identify --json` prints it.
    fn json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&self.0.document()).map_err(Raised::raised)
    }

    /// The model file with the identified values.
    fn model(&self) -> PyResult<Model> {
        let text = self.0.model_text().map_err(Raised::raised)?;
        socam_model::Model::parse(&text).map(Model).map_err(Raised::raised)
    }
}

/// Fits the free parameters of a model to recordings.
#[pyfunction]
#[pyo3(signature = (recordings, model, *, holdout, progress: "object" = None, **options: "object"))]
pub(crate) fn identify(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: &Model,
    holdout: Vec<Py<Recording>>,
    progress: Option<Bound<'_, PyAny>>,
    options: Option<Bound<'_, PyDict>>,
) -> PyResult<Identification> {
    let task: Identify = settings(options.as_ref())?;
    let model = task.model.changed(model.0.clone()).map_err(Raised::raised)?;
    let model = task.calibrated(model, recording::paths(&recordings)).map_err(Raised::raised)?;
    let (training, holdout) = (all(&recordings), all(&holdout));
    let done = waiting::run(py, progress.as_ref(), move |shared| {
        let grid = Grid::Fit;
        let (training, holdout) = (grid.apply_all(training)?, grid.apply_all(holdout)?);
        let mut done = task.run(&model, &training, &holdout, waiting::watch(shared))?;
        done.result.warnings.splice(0..0, model.warnings);
        Ok(done)
    })?;
    done.map(Identification).map_err(|error: JobError| error.raised())
}
