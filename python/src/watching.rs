//! `watch`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use socam_job::{Grid, JobError, Watch};
use socam_monitoring::Document;

use crate::errors::Raised;
use crate::model::Model;
use crate::options::settings;
use crate::recording::{Recording, all};
use crate::waiting;

/// Monitors recordings against a model: the document `socam.watch/1`.
#[pyfunction]
#[pyo3(signature = (recordings, model, *, baseline, **options: "object"))]
pub(crate) fn watch(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: &Model,
    baseline: Vec<Py<Recording>>,
    options: Option<Bound<'_, PyDict>>,
) -> PyResult<String> {
    let task: Watch = settings(options.as_ref())?;
    let model = task.model.changed(model.0.clone()).map_err(Raised::raised)?;
    let (data, healthy) = (all(&recordings), all(&baseline));
    let done = waiting::run(py, None, move |_| {
        let grid = Grid::Even(&model);
        let known = task.watching.baseline(&model, &grid.apply_all(healthy)?)?;
        let data = grid.apply_all(data)?;
        let each = data.iter().map(|data| Ok(task.run(&model, known.clone(), data)?.0));
        Ok::<_, JobError>(Document::new(&model.name, each.collect::<socam_job::Result<Vec<_>>>()?))
    })?;
    serde_json::to_string_pretty(&done.map_err(Raised::raised)?).map_err(Raised::raised)
}
