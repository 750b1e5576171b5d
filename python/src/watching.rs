//! `watch`.

use pyo3::prelude::*;
use socam_watch::{Baseline, Document, Settings, Watch, WatchError, Watched};

use crate::errors::Raised;
use crate::model::Model;
use crate::recording::{self, Recording};
use crate::waiting;

/// Watches recordings against a model: the document `socam.watch/1`. Settings that are not given have their defaults.
#[pyfunction]
#[pyo3(signature = (recordings, model, *, baseline, false_alarms_per_hour, window_s, block_s, learn_s))]
#[expect(clippy::too_many_arguments, reason = "the Python half names each of them")]
pub(crate) fn watch(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: &Model,
    baseline: Vec<Py<Recording>>,
    false_alarms_per_hour: f64,
    window_s: Option<f64>,
    block_s: Option<f64>,
    learn_s: Option<f64>,
) -> PyResult<String> {
    let usual = Settings::default();
    let settings = Settings {
        false_alarms_per_hour,
        window_s: window_s.unwrap_or(usual.window_s),
        block_s: block_s.unwrap_or(usual.block_s),
        learn_s: learn_s.unwrap_or(usual.learn_s),
    };
    let model = model.0.clone();
    let datasets = recording::for_fit(&recordings, &model, socam_expectation::GRID_PARTS)?;
    let healthy = recording::for_fit(&baseline, &model, socam_expectation::GRID_PARTS)?;
    let done = waiting::run(py, None, move |_| {
        let known = if healthy.is_empty() { None } else { Some(Baseline::of(&model, &healthy, &settings)?) };
        let each = datasets.iter().map(|data| {
            let watch = Watch::new(&model, data.channels(), known.clone(), settings.clone())?;
            Watched::of(watch, data).map(|(watched, _)| watched)
        });
        Ok::<_, WatchError>(Document::new(&model.name, each.collect::<Result<Vec<_>, _>>()?))
    })?;
    serde_json::to_string_pretty(&done.map_err(Raised::raised)?).map_err(Raised::raised)
}
