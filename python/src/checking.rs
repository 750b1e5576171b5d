//! `check`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use socam_job::{Check, Grid};
use socam_recording::check::Document;

use crate::errors::Raised;
use crate::model::Model;
use crate::options::settings;
use crate::recording::{Recording, all};
use crate::waiting;

/// Checks recordings before any fit: the document `socam.check/1`. Without a model all channels are checked.
#[pyfunction]
#[pyo3(signature = (recordings, model = None, **options: "object"))]
pub(crate) fn check(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: Option<&Model>,
    options: Option<Bound<'_, PyDict>>,
) -> PyResult<String> {
    let task: Check = settings(options.as_ref())?;
    let (data, model) = (all(&recordings), model.map(|model| model.0.clone()));
    let checks = waiting::run(py, None, move |_| {
        let on_grid = Grid::View.apply_all(data)?;
        on_grid.iter().map(|data| task.run(model.as_ref(), data)).collect::<socam_job::Result<Vec<_>>>()
    })?;
    serde_json::to_string_pretty(&Document::new(&checks.map_err(Raised::raised)?)).map_err(Raised::raised)
}
