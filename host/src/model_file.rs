//! `--model`: an embedded model's name or a model file.

use std::path::Path;

use anyhow::Context;
use socam_model::{BUILTIN, Intersample, Model};

use crate::output::WrongArguments;

/// Help of every `--model`.
pub(crate) const HELP: &str = "Model file (`template model` prints one to start from), or an embedded model: speed-o-cam, two-mass, emps, emps-loop";

/// Loads the model that `--model` names.
pub(crate) fn load(name: &str) -> anyhow::Result<Model> {
    Model::parse(&text(name)?).with_context(|| format!("the model file `{name}` cannot be used"))
}

/// The text of the model that `--model` names, as a recording keeps it.
pub(crate) fn text(name: &str) -> anyhow::Result<String> {
    if let Some((_, text)) = BUILTIN.iter().find(|(builtin, _)| *builtin == name) {
        return Ok((*text).to_owned());
    }
    if !Path::new(name).exists() {
        let names: Vec<_> = BUILTIN.iter().map(|(name, _)| *name).collect();
        let message =
            format!("there is no model file `{name}`, and embedded models are {}", names.join(", "));
        return Err(WrongArguments(message).into());
    }
    socam_recording::read_text(Path::new(name))
        .with_context(|| format!("cannot read the model file `{name}`"))
}

/// Help of every `--between`.
pub(crate) const BETWEEN_HELP: &str = "How inputs move between their samples: auto, hold, linear or band-limited, for all of them or as INPUT=KIND for one; may be repeated [default: what the model file says, else auto: band-limited for a motion, linear for a torque, a force, a voltage or a reference]";

/// Applies `KIND` and `INPUT=KIND` settings of `--between`.
pub(crate) fn set_between(model: &mut Model, settings: &[String]) -> anyhow::Result<()> {
    let inputs = model.inputs().filter(|input| !input.quantity.is_clock());
    let inputs: Vec<String> = inputs.map(|input| input.name.clone()).collect();
    for setting in settings {
        let wrong = |why: String| WrongArguments(format!("--between {setting}: {why}"));
        let (name, word) = match setting.split_once('=') {
            Some((name, word)) => (Some(name.trim()), word.trim()),
            None => (None, setting.trim()),
        };
        let kind = match word {
            "auto" => None,
            // What `simulate` called them once.
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
            return Err(wrong(format!("inputs of {} are {}", model.name, inputs.join(", "))).into());
        }
        for input in named {
            model.set_intersample(input, kind)?;
        }
    }
    Ok(())
}

/// Applies `NAME=VALUE` (SI) settings.
pub(crate) fn set(model: &mut Model, settings: &[String], fix: bool) -> anyhow::Result<()> {
    for setting in settings {
        let wrong = |why: String| WrongArguments(format!("`{setting}`: {why}"));
        let (name, value) = match setting.split_once('=') {
            Some((name, value)) => (name.trim(), Some(value.trim())),
            None => (setting.trim(), None),
        };
        let value =
            value.map(|text| text.parse::<f64>().map_err(|_| wrong(format!("`{text}` is no number"))));
        let set = model.set_parameter(name, value.transpose()?, fix);
        set.map_err(|error| wrong(error.to_string()))?;
    }
    model.equations(&model.values())?;
    Ok(())
}
