//! `compare`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use socam_compare::{Document, Options};

use crate::errors::Raised;
use crate::recording::{self, Recording};
use crate::waiting;

/// A recording beside a simulation.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct Comparison(socam_compare::Comparison);

#[pymethods]
impl Comparison {
    /// The document `socam.compare/1`, as `socam-host compare --json` prints it.
    fn json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&Document::new(&self.0, None)).map_err(Raised::raised)
    }

    /// A page about it; `about` are lines about how it was made.
    fn page(&self, about: Vec<String>) -> String {
        socam_report::comparison::page(&self.0, &about)
    }
}

/// Compares a recording with the output of a simulator: channels of the same name and unit, and those of `maps`, `SIMULATED=MEASURED`.
#[pyfunction]
#[pyo3(signature = (recording, simulation, *, maps, offset_s, false_alarm_rate))]
pub(crate) fn compare(
    py: Python<'_>,
    recording: Py<Recording>,
    simulation: Py<Recording>,
    maps: Vec<String>,
    offset_s: f64,
    false_alarm_rate: f64,
) -> PyResult<Comparison> {
    if !(false_alarm_rate > 0.0 && false_alarm_rate < 1.0) {
        let message = format!("false_alarm_rate: {false_alarm_rate} is not between 0 and 1");
        return Err(PyValueError::new_err(message));
    }
    if !offset_s.is_finite() {
        return Err(PyValueError::new_err(format!("offset_s: {offset_s}; expected seconds")));
    }
    let (measured, simulated) = (recording.get().data.clone(), simulation.get().data.clone());
    let done = waiting::run(py, None, move |_| {
        let measured = recording::regular(&measured)?;
        let simulated = socam_compare::shifted(simulated, offset_s)?;
        let pairing = socam_compare::pair(&measured, &simulated, &maps)?;
        Ok::<_, socam_compare::CompareError>(socam_compare::compare(&pairing, &Options { false_alarm_rate }))
    })?;
    done.map(Comparison).map_err(Raised::raised)
}
