//! `simulate`: the virtual bench on a profile, and a model driven by a recording's inputs.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::json;
use socam_identify::{Local, Options, Problem};
use socam_recording::{Dataset, ProfileFile};
use socam_sim::{Begin, Concealed, Override, Replay, Replayed, Setup, Start, Truth, calibration_for};

use crate::errors::Raised;
use crate::model::Model;
use crate::recording::{self, Recording};
use crate::waiting;

/// Points of a grid for each irregular sample, where inputs bend at their samples: those of the command line.
const GRID_PARTS: u32 = 4;

/// Names of the built-in profiles.
#[pyfunction]
pub(crate) fn profiles() -> Vec<&'static str> {
    ProfileFile::built_in_names().collect()
}

fn truth(model: &Model, values: Vec<(String, f64)>, hide: &[String]) -> PyResult<Truth> {
    let values: Vec<_> = values.into_iter().map(|(name, value)| Override { name, value }).collect();
    let hidden = hide.iter().map(|text| text.parse::<Concealed>()).collect::<Result<Vec<_>, _>>();
    let truth = hidden.and_then(|hidden| Truth::new(&model.0, &values, &hidden));
    truth.map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Records a profile (its name, or the text of a profile file) on the virtual bench of a model.
#[pyfunction]
#[pyo3(signature = (model, profile, *, name, duration_s, rate_hz, values, hide, seed, noise))]
#[expect(clippy::too_many_arguments, reason = "the Python half names each of them")]
pub(crate) fn simulate(
    py: Python<'_>,
    model: &Model,
    profile: &str,
    name: String,
    duration_s: Option<f64>,
    rate_hz: f64,
    values: Vec<(String, f64)>,
    hide: Vec<String>,
    seed: u64,
    noise: bool,
) -> PyResult<Recording> {
    let file = match ProfileFile::built_in_text(profile) {
        Some(text) => ProfileFile::parse(text),
        None => ProfileFile::parse(profile),
    };
    let file = file.and_then(|file| match duration_s {
        Some(duration_s) => file.lasting(duration_s),
        None => Ok(file),
    });
    let wrong = |error: socam_recording::SettingsError| PyValueError::new_err(format!("profile: {error}"));
    let period_us = 1e6 / rate_hz;
    if !(50.0..=1e6).contains(&period_us) || (period_us - period_us.round()).abs() > 1e-9 * period_us {
        return Err(PyValueError::new_err(format!(
            "rate_hz: {rate_hz} Hz; a board samples at 1 to 20000 Hz, every whole number of microseconds"
        )));
    }
    let period_us = period_us.round() as u32;
    let profile = file.and_then(|file| file.profile(period_us)).map_err(wrong)?;
    let truth = truth(model, values, &hide)?;
    let mut setup = Setup::new(truth, calibration_for(&model.0), seed);
    setup.noisy = noise;
    let data = waiting::run(py, None, move |_| setup.record(name, &profile, period_us))?;
    Ok(Recording::new(data.map_err(Raised::raised)?))
}

/// Drives a model by the inputs of a recording. Returns the simulated recording, and how it differs: the document `socam.comparison/1`.
#[pyfunction]
#[pyo3(signature = (model, inputs, *, values, hide, from_rest))]
pub(crate) fn replay(
    py: Python<'_>,
    model: &Model,
    inputs: Py<Recording>,
    values: Vec<(String, f64)>,
    hide: Vec<String>,
    from_rest: bool,
) -> PyResult<(Recording, String)> {
    let truth = truth(model, values, &hide)?;
    let data = recording::for_fit(std::slice::from_ref(&inputs), &truth.model, GRID_PARTS)?.remove(0);
    let (model, input) = (truth.model.clone(), data.name().to_owned());
    let replayed = waiting::run(py, None, move |_| {
        let start = if from_rest { Start::Rest } else { fitted_start(&truth, &data) };
        Replay { truth, disturbances: Vec::new(), start }.run(&data)
    })?;
    let replayed = replayed.map_err(Raised::raised)?;
    let document = comparison(&model, &input, from_rest, &replayed).to_string();
    let simulated = Dataset::from_columns(input, replayed.columns, replayed.time_s, replayed.values);
    Ok((Recording::new(simulated.map_err(Raised::raised)?), document))
}

/// Start states that fit the whole recording best, as `identify` estimates them; those that the simulator computes where it cannot.
fn fitted_start(truth: &Truth, data: &Dataset) -> Start {
    let problem = Problem::of_known(&truth.model, std::slice::from_ref(data), Options::default());
    let fitted = problem.and_then(|problem| socam_identify::start_states(&problem, &truth.values));
    let begin = |Local { first_row, states, offsets, .. }: Local| Begin { first_row, states, offsets };
    fitted.map_or(Start::Fitted, |fitted| Start::Given(fitted.into_iter().map(begin).collect()))
}

fn comparison(
    model: &socam_model::Model,
    input: &str,
    from_rest: bool,
    replayed: &Replayed,
) -> serde_json::Value {
    let kinds = model.inputs().filter(|input| !input.quantity.is_clock());
    let between: serde_json::Map<_, _> =
        kinds.map(|input| (input.name.clone(), input.intersample().name().into())).collect();
    let channel = |error: &socam_sim::OutputError| {
        json!({
            "channel": error.channel, "unit": error.unit, "samples": error.samples, "rms": error.rms, "max": error.max,
            "relative_percent": error.relative_percent,
        })
    };
    json!({
        "schema": "socam.comparison/1", "model": model.name, "input": input, "output": null, "between": between,
        "start": if from_rest { "rest" } else { "fitted" }, "rows": replayed.time_s.len(),
        "channels": replayed.errors.iter().map(channel).collect::<Vec<_>>(),
    })
}
