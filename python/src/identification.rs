//! `identify`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use socam_calibrate::sensors;
use socam_identify::{
    Band, Document, ForceError, IdentifyError, Noise, NoiseLevels, Options, Problem, StartState, Validation,
};

use crate::errors::Raised;
use crate::model::Model;
use crate::recording::{self, Recording};
use crate::waiting;

/// The result of a fit.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct Identification {
    result: socam_identify::Identification,
    training: Vec<ForceError>,
    validation: Vec<Validation>,
    /// The model without the gains of its sensors, which belong to the calibration.
    model: socam_model::Model,
}

#[pymethods]
impl Identification {
    /// The document `socam.identification/1`, as `socam-host identify --json` prints it.
    fn json(&self) -> PyResult<String> {
        let document =
            Document { result: &self.result, training: &self.training, validation: &self.validation };
        serde_json::to_string_pretty(&document).map_err(Raised::raised)
    }

    /// The model file with the identified values.
    fn model(&self) -> PyResult<Model> {
        let text = self.result.model_text(&self.model).map_err(Raised::raised)?;
        socam_model::Model::parse(&text).map(Model).map_err(Raised::raised)
    }
}

/// Parses the start state of recordings.
pub(crate) fn start_state(start: &str) -> PyResult<StartState> {
    match start {
        "free" => Ok(StartState::Free),
        "equilibrium" => Ok(StartState::Equilibrium),
        _ => Err(PyValueError::new_err(format!("start: `{start}` is neither free nor equilibrium"))),
    }
}

/// What a fit is made of.
struct Task {
    model: socam_model::Model,
    training: Vec<socam_recording::Dataset>,
    holdout: Vec<socam_recording::Dataset>,
    options: Options,
    band: Option<Band>,
    by_inverse_dynamics: bool,
}

/// Fits the free parameters of a model to recordings.
#[pyfunction]
#[pyo3(signature = (recordings, model, *, method, holdout, starts, seed, start, noise, band, progress: "object" = None))]
#[expect(clippy::too_many_arguments, reason = "the Python half names each of them")]
pub(crate) fn identify(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    model: &Model,
    method: &str,
    holdout: Vec<Py<Recording>>,
    starts: usize,
    seed: u64,
    start: &str,
    noise: Vec<(String, f64)>,
    band: Option<(f64, f64)>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Identification> {
    let by_inverse_dynamics = match method {
        "output-error" => false,
        "inverse-dynamics" => true,
        _ => {
            let message = format!("method: `{method}` is neither output-error nor inverse-dynamics");
            return Err(PyValueError::new_err(message));
        }
    };
    let uncalibrated = model.0.clone();
    let (calibration, unused) = sensors::of_recordings(recording::paths(&recordings));
    let model = match calibration.filter(|_| !by_inverse_dynamics) {
        Some(calibration) => sensors::with_sensor_gains(&model.0, &calibration).map_err(Raised::raised)?,
        None => uncalibrated.clone(),
    };
    let band = band.map(|(low, high)| Band::new(low, high)).transpose();
    let band = band.map_err(|error| PyValueError::new_err(error.to_string()))?;
    let noise = if noise.is_empty() {
        Noise::Estimated
    } else {
        let levels = NoiseLevels::by_name(&model, &noise);
        Noise::Given(levels.map_err(|error| PyValueError::new_err(error.to_string()))?)
    };
    let start_state = start_state(start)?;
    let options =
        Options { noise, start_state, try_other_intersamples: true, starts, seed, ..Options::default() };
    let training = recording::for_fit(&recordings, &model, socam_expectation::GRID_PARTS)?;
    let holdout = recording::for_fit(&holdout, &model, socam_expectation::GRID_PARTS)?;
    let task = Task { model, training, holdout, options, band, by_inverse_dynamics };
    let done = waiting::run(py, progress.as_ref(), move |shared| {
        let watch = waiting::watch(shared);
        fitted(Task { options: Options { watch, ..task.options.clone() }, ..task })
    })?;
    let (mut result, training, validation) = done.map_err(Raised::raised)?;
    result.warnings.splice(0..0, unused);
    Ok(Identification { result, training, validation, model: uncalibrated })
}

type Fitted = (socam_identify::Identification, Vec<ForceError>, Vec<Validation>);

fn fitted(task: Task) -> Result<Fitted, IdentifyError> {
    let Task { model, training, holdout, options, band, by_inverse_dynamics } = task;
    let result = if by_inverse_dynamics {
        socam_identify::inverse_dynamics(&model, &training)?
    } else {
        socam_identify::output_error(&Problem::new(&model, &training, options.clone())?)?
    };
    let validation = socam_identify::validate(&model, &holdout, &result, &options, band)?;
    let errors = socam_identify::force_errors(&model, &training, &result)?;
    Ok((result, errors, validation))
}
