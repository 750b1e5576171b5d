//! `design`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use socam_job::{Design, Rival};

use crate::errors::Raised;
use crate::model::Model;
use crate::options::settings;
use crate::recording::{Recording, all};
use crate::waiting;

/// Proposes the next experiment: the document `socam.design/1`.
#[pyfunction]
#[pyo3(signature = (model, recordings, *, rival, names, progress: "object" = None, **options: "object"))]
pub(crate) fn design(
    py: Python<'_>,
    model: &Model,
    recordings: Vec<Py<Recording>>,
    rival: Option<&Model>,
    names: [String; 2],
    progress: Option<Bound<'_, PyAny>>,
    options: Option<Bound<'_, PyDict>>,
) -> PyResult<String> {
    let task: Design = settings(options.as_ref())?;
    let model = task.model.changed(model.0.clone()).map_err(Raised::raised)?;
    let (model, rival) = match rival {
        Some(rival) => (model, Some(Rival { model: rival.0.clone(), names })),
        None => task.with_rival(model).map_err(Raised::raised)?,
    };
    let recorded = all(&recordings);
    let done = waiting::run(py, progress.as_ref(), move |shared| {
        let tried = |count: usize| shared.tell(format!("{count} profiles tried"));
        let done = task.run(&model, rival, &recorded, &tried)?;
        Ok(serde_json::to_string_pretty(&done.document()))
    })?;
    done.map_err(|error: socam_job::JobError| error.raised())?.map_err(Raised::raised)
}
