//! `design`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use socam_design::{Document, Limits, Rig, five_steps};
use socam_sim::{Setup, Truth, calibration_for};

use crate::errors::Raised;
use crate::model::Model;
use crate::recording::Recording;
use crate::waiting;

/// Largest command of the profiles that suit the default bench, V.
const USUAL_V: f64 = 1.8;

/// Proposes the next experiment: the document `socam.design/1`.
#[pyfunction]
#[pyo3(signature = (model, recordings, *, rival, names, duration_s, voltage, slew_v_s, limits, one_way, progress: "object" = None))]
#[expect(clippy::too_many_arguments, reason = "the Python half names each of them")]
pub(crate) fn design(
    py: Python<'_>,
    model: &Model,
    recordings: Vec<Py<Recording>>,
    rival: Option<&Model>,
    names: [String; 2],
    duration_s: f64,
    voltage: Option<f64>,
    slew_v_s: f64,
    limits: Vec<(String, f64)>,
    one_way: bool,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<String> {
    let mut calibration = calibration_for(&model.0);
    for (name, limit) in limits {
        let known: Vec<String> = calibration.channels.iter().map(|c| c.channel.name.clone()).collect();
        let channel = calibration.channels.iter_mut().find(|channel| channel.channel.name == name);
        let channel = channel.filter(|_| limit > 0.0 && limit.is_finite()).ok_or_else(|| {
            let known = known.join(", ");
            PyValueError::new_err(format!(
                "limits: {name}={limit}; expected one of {known} and a positive number"
            ))
        })?;
        channel.limit = Some(limit);
    }
    let voltage = voltage.unwrap_or(USUAL_V.min(calibration.clamp_v));
    let limits = Limits { voltage, slew_v_s, duration_s, one_way };
    let wrong = |message: String| PyValueError::new_err(message);
    let truth = Truth::new(&model.0, &[], &[]).map_err(|error| wrong(error.to_string()))?;
    let rig =
        Rig::new(Setup::new(truth, calibration, 1), limits).map_err(|error| wrong(error.to_string()))?;
    let recorded: Vec<_> = recordings.iter().map(|recording| recording.get().data.clone()).collect();
    let (model, rival) = (model.0.clone(), rival.map(|rival| rival.0.clone()));
    let document = waiting::run(py, progress.as_ref(), move |shared| {
        let tried = |count: usize| shared.tell(format!("{count} profiles tried"));
        let design = match &rival {
            Some(rival) => socam_design::telling_apart(&model, rival, &rig, &tried)?,
            None => socam_design::sharpest(&model, &rig, &recorded, &tried)?,
        };
        let reference = match rival {
            Some(_) => None,
            None => socam_design::foretell(&rig, &model, &recorded, &five_steps(&rig.limits()))?,
        };
        let names = rival.is_some().then_some(names);
        let profile = design.profile(&model.name, names.as_ref()).to_toml();
        let widths = reference.as_ref().map(|(_, widths)| widths.as_slice());
        Ok(serde_json::to_string_pretty(&Document::new(&design, profile, names, widths)))
    })?;
    document.map_err(|error: socam_design::DesignError| error.raised())?.map_err(Raised::raised)
}
