//! `check`.

use pyo3::prelude::*;
use socam_recording::check::{Check, CheckOptions, Document};

use crate::errors::Raised;
use crate::model::Model;
use crate::recording::{self, Recording};
use crate::waiting;

/// Checks recordings before any fit: the document `socam.check/1`. Without a model all channels are checked.
#[pyfunction]
#[pyo3(signature = (recordings, model = None, *, input = None, ratio_tolerance = 0.01))]
pub(crate) fn check(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: Option<&Model>,
    input: Option<String>,
    ratio_tolerance: f64,
) -> PyResult<String> {
    let options = match model {
        Some(model) => socam_expectation::of_model(&model.0, ratio_tolerance),
        None => CheckOptions { input, ..CheckOptions::default() },
    };
    let all: Vec<_> = recordings.iter().map(|recording| recording.get().data.clone()).collect();
    let checks = waiting::run(py, None, move |_| {
        let one = |data: &socam_recording::Dataset| {
            socam_recording::check::check(&recording::regular(data)?, &options)
        };
        all.iter().map(one).collect::<socam_recording::Result<Vec<Check>>>()
    })?;
    serde_json::to_string_pretty(&Document::new(&checks.map_err(Raised::raised)?)).map_err(Raised::raised)
}
