//! `identify --method frf`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use socam_job::{Grid, JobError, Response};

use crate::errors::Raised;
use crate::model::Model;
use crate::options::settings;
use crate::recording::{Recording, all};
use crate::waiting;

/// Results for one output: sentences about its unexcited lines, and pictures by name, as SVG.
type Seen = (Vec<String>, Vec<(String, String)>);

/// Frequency responses: the document `socam.frequency-response/1`, the results for each output, and warnings and notes about all outputs.
#[pyfunction]
#[pyo3(signature = (recordings, model, **options: "object"))]
pub(crate) fn frf(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: &Model,
    options: Option<Bound<'_, PyDict>>,
) -> PyResult<(String, Vec<Seen>, Vec<String>)> {
    let task: Response = settings(options.as_ref())?;
    let model = task.model.changed(model.0.clone()).map_err(Raised::raised)?;
    let data = all(&recordings);
    let done = waiting::run(py, None, move |_| {
        let datasets = Grid::View.apply_all(data)?;
        let names: Vec<String> = datasets.iter().map(|data| data.name().to_owned()).collect();
        let done = task.run(&model, &datasets, &names)?;
        let seen = done.answers.iter().map(|answer| {
            let drawn = socam_report::response::pictures(answer);
            let drawn = drawn.iter().map(|picture| (picture.name.to_owned(), picture.svg()));
            (answer.distortion_sentences(), drawn.collect())
        });
        let said =
            done.answers.iter().flat_map(|answer| answer.warnings.iter().chain(&answer.notes).cloned());
        Ok::<_, JobError>((format!("{:#}", done.document), seen.collect(), said.collect()))
    })?;
    done.map_err(Raised::raised)
}
