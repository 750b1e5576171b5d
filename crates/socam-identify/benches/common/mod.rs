//! The reference problems of other people's solvers, from the folder that `SOCAM_BENCH` names.

use std::{error::Error, path::PathBuf};

use serde_json::Value;
use socam_model::{BUILTIN, Model};

/// The folder; `None`, and a word about it, without the variable.
pub(crate) fn folder(bench: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("SOCAM_BENCH").map(PathBuf::from);
    if folder.is_none() {
        println!("{bench}: skipped, SOCAM_BENCH names no folder with the reference problems");
    }
    folder
}

/// A list of numbers of `truth.json`.
pub(crate) fn numbers(truth: &Value, key: &str) -> Vec<f64> {
    truth[key].as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

/// The drivetrain of the problem `kind` (`lin`, or `nl` with friction at the load), its unknown parameters at `values`, in the
/// order of [`NAMES`].
pub(crate) fn model(truth: &Value, kind: &str, values: &[f64]) -> Result<Model, Box<dyn Error>> {
    let mut text = BUILTIN[0].1.to_owned();
    if kind == "nl" {
        text = text.replace("J2 = {", "Tc = { value = 0.6, unit = \"N m\", bounds = [0, 100] }\nws = { value = 0.05, unit = \"rad/s\", fixed = true }\nJ2 = {");
        text.push_str("\n[[effects]]\neffect = \"coulomb_friction\"\nat = \"load_bearing\"\nparameters = { torque = \"Tc\", transition_speed = \"ws\" }\n");
    }
    let mut model = Model::parse(&text)?;
    for (name, value) in NAMES.iter().zip(values) {
        if let Some(index) = model.parameter(name) {
            model.parameters[index].value = *value;
        }
    }
    for (name, value) in truth["constants"].as_object().into_iter().flatten() {
        if let (Some(index), Some(value)) = (model.parameter(name), value.as_f64()) {
            model.parameters[index].value = value;
        }
    }
    Ok(model)
}

/// The unknown parameters.
pub(crate) const NAMES: [&str; 9] = ["k1", "k2", "k3", "k4", "c2", "c3", "c4", "c5", "Tc"];
