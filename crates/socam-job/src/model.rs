//! The model of a task: an embedded one by its name, or a model file; and changes of it.

use std::path::Path;

use serde::{Deserialize, Serialize};
use socam_model::{BUILTIN, Intersample, Model};

use crate::error::{JobError, Result};
use crate::notation;

/// Help of every option that names a model.
pub const MODEL_HELP: &str = "Model file (`template model` prints one to start from), or an embedded model: speed-o-cam, two-mass, emps, emps-loop, gearmotor";

/// Help of `--between`.
pub(crate) const BETWEEN_HELP: &str = "How inputs move between their samples: auto, hold, linear or band-limited, for all of them or as INPUT=KIND for one; may be repeated [default: what the model file says, else auto: what fits the recordings best, and where they do not tell, band-limited for a motion, linear for a torque, a force, a voltage or a reference]";

/// The model, and what of it is changed
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct ModelSettings {
    /// Name of an embedded model, or path of a model file.
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = MODEL_HELP)]
    pub model: String,
    /// Fix a parameter at its value in the model or at the given value (SI); may be repeated
    #[arg(long = "fix", value_name = "NAME[=VALUE]")]
    #[serde(deserialize_with = "notation::texts")]
    pub fixed: Vec<String>,
    /// Start value of a parameter (SI); may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE")]
    #[serde(deserialize_with = "notation::texts")]
    pub start_values: Vec<String>,
    /// `KIND` for all inputs or `INPUT=KIND` for one.
    #[arg(long, value_name = "[INPUT=]KIND", help = BETWEEN_HELP)]
    #[serde(deserialize_with = "notation::texts")]
    pub between: Vec<String>,
}

impl ModelSettings {
    /// Loads the model and changes it.
    ///
    /// # Errors
    /// When there is no such model, its file has a mistake, or it refuses a change.
    pub fn load(&self) -> Result<Model> {
        self.changed(load_model(&self.model)?)
    }

    /// The given model with the changes.
    ///
    /// # Errors
    /// When the model refuses a change.
    pub fn changed(&self, mut model: Model) -> Result<Model> {
        set_parameters(&mut model, &self.start_values, false)?;
        set_parameters(&mut model, &self.fixed, true)?;
        set_between(&mut model, &self.between)?;
        Ok(model)
    }
}

/// The model of this name: an embedded one, or a model file.
///
/// # Errors
/// When there is no such model, or its file has a mistake.
pub fn load_model(name: &str) -> Result<Model> {
    let text = model_text(name)?;
    if text.trim_start().starts_with('<') {
        return Err(JobError::Description(name.into()));
    }
    Model::parse(&text).map_err(|source| JobError::ModelFile { name: name.into(), source })
}

/// The text of the model of this name, as a recording keeps it.
///
/// # Errors
/// When there is no such model, or its file cannot be read.
pub fn model_text(name: &str) -> Result<String> {
    if let Some((_, text)) = BUILTIN.iter().find(|(builtin, _)| *builtin == name) {
        return Ok((*text).to_owned());
    }
    if !Path::new(name).exists() {
        let names: Vec<_> = BUILTIN.iter().map(|(name, _)| *name).collect();
        return Err(JobError::NoModel { name: name.into(), embedded: names.join(", ") });
    }
    let read = socam_recording::read_text(Path::new(name));
    read.map_err(|source| JobError::Read { what: format!("the model file `{name}`"), source })
}

/// Applies `NAME=VALUE` (SI) or `NAME` settings.
fn set_parameters(model: &mut Model, settings: &[String], fix: bool) -> Result<()> {
    for setting in settings {
        let (name, value) = match setting.split_once('=') {
            Some((name, value)) => (name.trim(), Some(value.trim())),
            None => (setting.trim(), None),
        };
        let number = |text: &str| {
            let wrong = |_| JobError::Inputs(format!("`{setting}`: `{text}` is no number"));
            text.parse::<f64>().map_err(wrong)
        };
        let set = model.set_parameter(name, value.map(number).transpose()?, fix);
        set.map_err(|error| JobError::Change { setting: setting.clone(), error })?;
    }
    model.equations(&model.values())?;
    Ok(())
}

/// Applies `KIND` and `INPUT=KIND` settings.
pub(crate) fn set_between(model: &mut Model, settings: &[String]) -> Result<()> {
    let inputs = model.inputs().filter(|input| !input.quantity.is_clock());
    let inputs: Vec<String> = inputs.map(|input| input.name.clone()).collect();
    for setting in settings {
        let wrong = |why: String| JobError::value("between", "--between", format!(" {setting}: {why}"));
        let (name, word) = match setting.split_once('=') {
            Some((name, word)) => (Some(name.trim()), word.trim()),
            None => (None, setting.trim()),
        };
        let kind = match word {
            "auto" => None,
            // Earlier names of these words in `simulate`.
            "line" => Some(Intersample::Linear),
            "step" => Some(Intersample::Hold),
            word => Some(
                word.parse()
                    .map_err(|_| wrong(format!("`{word}` is none of auto, hold, linear and band-limited")))?,
            ),
        };
        let named: Vec<&String> =
            inputs.iter().filter(|input| name.is_none_or(|name| name == *input)).collect();
        if named.is_empty() {
            return Err(wrong(format!("inputs of {} are {}", model.name, inputs.join(", "))));
        }
        for input in named {
            model.set_intersample(input, kind)?;
        }
    }
    Ok(())
}
