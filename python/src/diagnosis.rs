//! `diagnose`.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use socam_diagnose::Answer;
use socam_findings::headline::marks;
use socam_job::{Diagnose, Diagnosed, Grid, HeldOutRecording};
use socam_report::{Provenance, diagnosis};

use crate::errors::Raised;
use crate::model::Model;
use crate::options::settings;
use crate::recording::{Recording, all};
use crate::waiting;

/// The result of a diagnosis.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct Diagnosis(Diagnosed);

#[pymethods]
impl Diagnosis {
    /// The document `socam.diagnosis/1`, as `socam-host diagnose --json` prints it.
    fn json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(self.0.document()).map_err(Raised::raised)
    }

    /// The findings in one line.
    fn headline(&self) -> String {
        socam_findings::headline(self.0.document()).title
    }

    /// Sentences about the certainty of the findings, the most important first.
    fn certainty(&self) -> Vec<String> {
        socam_findings::headline(self.0.document()).certainty
    }

    /// The corrected model.
    fn model(&self) -> PyResult<Model> {
        socam_model::Model::parse(&self.0.answer.model_toml).map(Model).map_err(Raised::raised)
    }

    /// The bench with the places of the findings, as SVG.
    fn drawing(&self) -> String {
        socam_report::bench::svg(&self.0.model, &marks(self.0.document()))
    }

    /// The most improved channel, measured and predicted, as SVG.
    fn picture(&self) -> Option<String> {
        diagnosis::picture(self.0.document())
    }

    /// Writes index.html, diagnosis.json and model.toml into a folder; the page shows `date` unchanged.
    fn report(&self, py: Python<'_>, folder: PathBuf, date: String) -> PyResult<()> {
        let Answer { diagnosis: document, evidence, model_toml } = &self.0.answer;
        let made = Provenance { command: "socam.diagnose".into(), date, files: Vec::new() };
        let models = (&self.0.model, Some(model_toml.as_str()));
        let written = py.detach(|| diagnosis::write(&folder, document, evidence, models, &made));
        written.map_err(Raised::raised)
    }
}

/// Finds the physics that a model lacks, by recordings.
#[pyfunction]
#[pyo3(signature = (recordings, model, *, holdout, progress: "object" = None, **options: "object"))]
pub(crate) fn diagnose(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: &Model,
    holdout: Vec<Py<Recording>>,
    progress: Option<Bound<'_, PyAny>>,
    options: Option<Bound<'_, PyDict>>,
) -> PyResult<Diagnosis> {
    let task: Diagnose = settings(options.as_ref())?;
    let model = task.model.changed(model.0.clone()).map_err(Raised::raised)?;
    let (training, holdout) = (all(&recordings), all(&holdout));
    let done = waiting::run(py, progress.as_ref(), move |shared| {
        let training = Grid::Fit.apply_all(training)?;
        let holdout = holdout.into_iter().map(HeldOutRecording::Open).collect();
        task.run(model, &training, holdout, waiting::watch(shared))
    })?;
    done.map(Diagnosis).map_err(Raised::raised)
}
