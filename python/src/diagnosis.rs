//! `diagnose`.

use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use socam_answer::headline::marks;
use socam_diagnose::{Answer, HeldOut, Options};
use socam_recording::Dataset;
use socam_report::{Provenance, diagnosis};

use crate::errors::Raised;
use crate::identification::start_state;
use crate::model::Model;
use crate::recording::{self, Recording};
use crate::waiting;

/// The result of a diagnosis.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct Diagnosis {
    answer: Answer,
    model: socam_model::Model,
}

#[pymethods]
impl Diagnosis {
    /// The document `socam.diagnosis/1`, as `socam-host diagnose --json` prints it.
    fn json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&self.answer.diagnosis).map_err(Raised::raised)
    }

    /// What was found, in one line.
    fn headline(&self) -> String {
        socam_answer::headline(&self.answer.diagnosis).title
    }

    /// How sure that is, the most important sentence first.
    fn certainty(&self) -> Vec<String> {
        socam_answer::headline(&self.answer.diagnosis).certainty
    }

    /// The corrected model.
    fn model(&self) -> PyResult<Model> {
        socam_model::Model::parse(&self.answer.model_toml).map(Model).map_err(Raised::raised)
    }

    /// The bench with the places of the findings, as SVG.
    fn drawing(&self) -> String {
        socam_report::bench::svg(&self.model, &marks(&self.answer.diagnosis))
    }

    /// The most improved channel, measured and predicted, as SVG.
    fn picture(&self) -> Option<String> {
        diagnosis::picture(&self.answer.diagnosis)
    }

    /// Writes index.html, diagnosis.json and model.toml into a folder; the page shows the date as it is given.
    fn report(&self, py: Python<'_>, folder: PathBuf, date: String) -> PyResult<()> {
        let Answer { diagnosis: document, evidence, model_toml } = &self.answer;
        let made = Provenance { command: "socam.diagnose".into(), date, files: Vec::new() };
        let models = (&self.model, Some(model_toml.as_str()));
        let written = py.detach(|| diagnosis::write(&folder, document, evidence, models, &made));
        written.map_err(Raised::raised)
    }
}

/// Finds the physics that a model lacks, by recordings.
#[pyfunction]
#[pyo3(signature = (recordings, model, *, holdout, false_alarm_rate, tolerance, most, seed, start, progress: "object" = None))]
#[expect(clippy::too_many_arguments, reason = "the Python half names each of them")]
pub(crate) fn diagnose(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: &Model,
    holdout: Vec<Py<Recording>>,
    false_alarm_rate: f64,
    tolerance: f64,
    most: usize,
    seed: u64,
    start: &str,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Diagnosis> {
    if !(false_alarm_rate > 0.0 && false_alarm_rate < 1.0) {
        let message = format!("false_alarm_rate: {false_alarm_rate} is not between 0 and 1");
        return Err(PyValueError::new_err(message));
    }
    if !(1..=6).contains(&most) {
        return Err(PyValueError::new_err(format!("most: {most} is not 1 to 6")));
    }
    let options = Options {
        false_alarm_rate,
        most_effects: most,
        tolerance,
        seed,
        start_state: start_state(start)?,
        ..Options::default()
    };
    let model = model.0.clone();
    // Outputs that are missing at most grid points would have no spectra.
    let training = recording::for_fit(&recordings, &model, 1)?;
    let holdout: Vec<Dataset> = holdout.iter().map(|recording| recording.get().data.clone()).collect();
    let own = model.clone();
    let answer = waiting::run(py, progress.as_ref(), move |shared| {
        let prepare = |data| socam_expectation::on_regular_grid(data, &own, 1);
        let held_out = holdout.into_iter().fold(HeldOut::none(), |all, data| all.with_dataset(data, prepare));
        let options = Options { watch: waiting::watch(shared), ..options };
        socam_diagnose::diagnose(&own, &training, held_out, &options)
    })?;
    Ok(Diagnosis { answer: answer.map_err(Raised::raised)?, model })
}
