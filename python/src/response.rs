//! `identify --method frf`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use socam_identify::Band;
use socam_recording::Dataset;
use socam_response::{ResponseError, Settings, document, estimate};

use crate::errors::Raised;
use crate::model::Model;
use crate::recording::{self, Recording};
use crate::waiting;

/// What the lines that nothing excites say, and pictures by name, as SVG, of one output.
type Seen = (Vec<String>, Vec<(String, String)>);

/// Frequency responses: the document `socam.frequency-response/1`, of each output what is seen in it, and warnings and notes of all.
#[pyfunction]
#[pyo3(signature = (recordings, model, *, outputs, reference, band, period_s, outliers, low_pass, quietest))]
#[expect(clippy::too_many_arguments, reason = "the Python half names each of them")]
pub(crate) fn frf(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: &Model,
    outputs: Vec<String>,
    reference: Option<String>,
    band: Option<(f64, f64)>,
    period_s: Option<f64>,
    outliers: Option<f64>,
    low_pass: Option<(f64, usize)>,
    quietest: bool,
) -> PyResult<(String, Vec<Seen>, Vec<String>)> {
    let band = band.map(|(low, high)| Band::new(low, high)).transpose();
    let band = band.map_err(|error| PyValueError::new_err(error.to_string()))?;
    for (name, value) in [("period_s", period_s), ("outliers", outliers)] {
        if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
            return Err(PyValueError::new_err(format!("{name}: {value}; expected a positive number")));
        }
    }
    let band_hz = band.map(|band| [band.low_hz(), band.high_hz()]);
    let settings = Settings { reference, band_hz, period_s, outliers, low_pass, quietest };
    let all: Vec<Dataset> = recordings.iter().map(|recording| recording.get().data.clone()).collect();
    let model = model.0.clone();
    let done = waiting::run(py, None, move |_| {
        let datasets = all.iter().map(recording::regular).collect::<socam_recording::Result<Vec<_>>>()?;
        let answers = estimate(&model, &datasets, &outputs, &settings)?;
        let names: Vec<String> = datasets.iter().map(|data| data.name().to_owned()).collect();
        let text = format!("{:#}", document(&model.name, &names, &answers));
        let seen = answers.iter().map(|answer| {
            let drawn = socam_report::response::pictures(answer);
            let drawn = drawn.iter().map(|picture| (picture.name.to_owned(), picture.svg()));
            (answer.distortion_sentences(), drawn.collect())
        });
        let said = answers.iter().flat_map(|answer| answer.warnings.iter().chain(&answer.notes).cloned());
        Ok::<_, ResponseError>((text, seen.collect(), said.collect()))
    })?;
    done.map_err(|error| match error {
        ResponseError::UnknownOutput { .. } => PyValueError::new_err(error.to_string()),
        ResponseError::Recording(error) => error.raised(),
        error => error.raised(),
    })
}
