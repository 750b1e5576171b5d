//! `compare`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use socam_job::{Compare, Compared, Grid, JobError};

use crate::errors::Raised;
use crate::options::settings;
use crate::recording::Recording;
use crate::waiting;

/// A recording compared with a simulation.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct Comparison(Compared);

#[pymethods]
impl Comparison {
    /// The document `socam.compare/1`, as `socam-host compare --json` prints it.
    fn json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&self.0.document()).map_err(Raised::raised)
    }

    /// A page about the comparison; `about` are lines about its origin.
    fn page(&self, about: Vec<String>) -> String {
        socam_report::comparison::page(&self.0.comparison, &about)
    }
}

/// Compares a recording with the output of a simulator: channels of the same name and unit, and the given pairs of channels.
#[pyfunction]
#[pyo3(signature = (recording, simulation, **options: "object"))]
pub(crate) fn compare(
    py: Python<'_>,
    recording: Py<Recording>,
    simulation: Py<Recording>,
    options: Option<Bound<'_, PyDict>>,
) -> PyResult<Comparison> {
    let task: Compare = settings(options.as_ref())?;
    let model = task.model.as_deref().map(socam_job::load_model).transpose().map_err(Raised::raised)?;
    let (measured, simulated) = (recording.get().data.clone(), simulation.get().data.clone());
    let done = waiting::run(py, None, move |_| {
        let driven =
            model.map(|model| Ok::<_, JobError>((Grid::Even(&model).apply(measured.clone())?, model)));
        let driven = driven.transpose()?;
        task.run(
            &Grid::View.apply(measured)?,
            simulated,
            driven.as_ref().map(|(inputs, model)| (model, inputs)),
        )
    })?;
    done.map(Comparison).map_err(Raised::raised)
}
