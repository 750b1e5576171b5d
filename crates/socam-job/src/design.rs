//! The next experiment: the most informative profile within a rig's limits.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use socam_design::{Document, Limits, Rig, Width, five_steps};
use socam_model::Model;
use socam_recording::{Calibration, Dataset};
use socam_sim::{Truth, calibration_for};

use crate::error::{JobError, Result};
use crate::model::{ModelSettings, load_model};
use crate::notation::{self, seconds};
use crate::options::Settings;

/// Largest command of the profiles that suit the default bench, V.
const USUAL_V: f64 = 1.8;

/// Settings of an experiment's design
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Design {
    /// The model.
    #[command(flatten)]
    #[serde(flatten)]
    pub model: ModelSettings,
    /// A competing model of the same recordings
    #[arg(long, value_name = "MODEL")]
    pub rival: Option<String>,
    /// The diagnosis.json of `diagnose --report`: compare its strongest finding with its first rival, each added to --model
    #[arg(long, value_name = "FILE", conflicts_with = "rival")]
    pub diagnosis: Option<PathBuf>,
    /// Length of the recording, as in 10s or 1.5min
    #[arg(long = "duration", value_name = "TIME", default_value = "10s", value_parser = seconds)]
    pub duration_s: f64,
    /// Largest command, V [default: 1.8, or the clamp of the calibration if that is less]
    #[arg(long, value_name = "VOLT")]
    pub voltage: Option<f64>,
    /// Fastest change of the command, V/s
    #[arg(long = "slew", value_name = "VOLT/S", default_value_t = 500.0)]
    pub slew_v_s: f64,
    /// Limit of a channel, SI, in place of the calibration's; may be repeated
    #[arg(long = "limit", value_name = "CHANNEL=VALUE")]
    #[serde(deserialize_with = "notation::texts")]
    pub limits: Vec<String>,
    /// Only profiles that do not change direction
    #[arg(long)]
    pub one_way: bool,
    /// Calibration file with motor, sensors and limits [default: one that suits the model]
    #[arg(long, value_name = "FILE")]
    pub calibration: Option<PathBuf>,
}

impl Settings for Design {
    const COMMAND: &'static [&'static str] = &["design"];
}

/// A rival model, and the names of both.
#[derive(Debug, Clone)]
pub struct Rival {
    /// The rival.
    pub model: Model,
    /// Names of the model and of its rival.
    pub names: [String; 2],
}

/// A proposal.
#[derive(Debug)]
pub struct Designed {
    /// The tried profiles, and the best of them.
    pub design: socam_design::Design,
    /// The text of the best profile's file.
    pub profile: String,
    /// Names of the two models that it distinguishes.
    pub tells_apart: Option<[String; 2]>,
    /// Expected intervals with the thesis' profile, for comparison.
    pub reference: Option<Vec<Width>>,
}

impl Designed {
    /// The document `socam.design/1`.
    #[must_use]
    pub fn document(&self) -> Document<'_> {
        let (profile, names) = (self.profile.clone(), self.tells_apart.clone());
        Document::new(&self.design, profile, names, self.reference.as_deref())
    }
}

impl Design {
    /// The model and its rival, if one is named.
    ///
    /// # Errors
    /// When there is no such model, or the diagnosis has no finding with a rival.
    pub fn load(&self) -> Result<(Model, Option<Rival>)> {
        self.with_rival(self.model.load()?)
    }

    /// A model and its rival, if one is named: for a diagnosis, the model with its finding.
    ///
    /// # Errors
    /// As [`Design::load`].
    pub fn with_rival(&self, base: Model) -> Result<(Model, Option<Rival>)> {
        if let Some(name) = &self.rival {
            let names = [self.model.model.clone(), name.clone()];
            return Ok((base, Some(Rival { model: load_model(name)?, names })));
        }
        let Some(path) = &self.diagnosis else { return Ok((base, None)) };
        let (found, rival) = of_diagnosis(&base, path)?;
        Ok((found, Some(rival)))
    }

    /// Tries profiles on a virtual bench of the model; `tried` is called after each with their number.
    ///
    /// # Errors
    /// When a limit is invalid, no profile keeps the limits, or the bench cannot be simulated.
    pub fn run(
        &self,
        model: &Model,
        rival: Option<Rival>,
        recorded: &[Dataset],
        tried: &(dyn Fn(usize) + Sync),
    ) -> Result<Designed> {
        let rig = self.rig(model)?;
        let design = match &rival {
            Some(rival) => socam_design::telling_apart(model, &rival.model, &rig, tried)?,
            None => socam_design::sharpest(model, &rig, recorded, tried)?,
        };
        let reference = match rival {
            Some(_) => None,
            None => socam_design::predicted_intervals(&rig, model, recorded, &five_steps(&rig.limits()))?,
        };
        let tells_apart = rival.map(|rival| rival.names);
        let profile = design.profile(&model.name, tells_apart.as_ref()).to_toml();
        Ok(Designed { design, profile, tells_apart, reference: reference.map(|(_, widths)| widths) })
    }

    fn rig(&self, model: &Model) -> Result<Rig> {
        let mut calibration = match &self.calibration {
            Some(path) => Calibration::open(path)?,
            None => calibration_for(model),
        };
        for text in &self.limits {
            let names: Vec<&str> = calibration.channels.iter().map(|c| c.channel.name.as_str()).collect();
            let wrong = || {
                let names = names.join(", ");
                let problem =
                    format!(" {text}: expected CHANNEL=VALUE with one of {names} and a positive number");
                JobError::value("limits", "--limit", problem)
            };
            let (name, value) = text.split_once('=').ok_or_else(wrong)?;
            let value: f64 = value
                .parse()
                .ok()
                .filter(|value: &f64| *value > 0.0 && value.is_finite())
                .ok_or_else(wrong)?;
            let index = names.iter().position(|known| *known == name).ok_or_else(wrong)?;
            calibration.channels[index].limit = Some(value);
        }
        let limits = Limits {
            voltage: self.voltage.unwrap_or(USUAL_V.min(calibration.clamp_v)),
            slew_v_s: self.slew_v_s,
            duration_s: self.duration_s,
            one_way: self.one_way,
        };
        let truth = Truth::new(model, &[], &[])?;
        let rig = Rig::new(socam_sim::Setup::new(truth, calibration, 1), limits);
        rig.map_err(|error| JobError::Inputs(error.to_string()))
    }
}

/// The first finding of a diagnosis that has a rival: the model with the finding, and the model with its first rival.
fn of_diagnosis(base: &Model, path: &Path) -> Result<(Model, Rival)> {
    let wrong = |problem: &str| JobError::Inputs(format!("`{}` {problem}", path.display()));
    let text = socam_recording::read_text(path)
        .map_err(|source| JobError::Read { what: format!("`{}`", path.display()), source })?;
    let diagnosis: serde_json::Value =
        serde_json::from_str(&text).map_err(|error| wrong(&format!("is no diagnosis: {error}")))?;
    let findings = diagnosis["findings"].as_array();
    let findings = findings
        .ok_or_else(|| wrong("is no diagnosis; expected what `diagnose --json` or --report wrote"))?;
    let doubted =
        findings.iter().find(|finding| finding["rivals"].as_array().is_some_and(|rivals| !rivals.is_empty()));
    let finding =
        doubted.ok_or_else(|| wrong("has no finding with a rival: there is nothing to tell apart"))?;
    let word = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let (effect, place) = (word(&finding["effect"]), word(&finding["location"]));
    let parameters = finding["parameters"].as_array().map_or(&[][..], Vec::as_slice);
    let values: Vec<(String, f64)> =
        parameters.iter().filter_map(|p| Some((word(&p["name"]), p["value"].as_f64()?))).collect();
    let values: Vec<(&str, f64)> = values.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let other = &finding["rivals"][0];
    let (other_effect, other_place) = (word(&other["effect"]), word(&other["location"]));
    let found = base.with_effect(&effect, &place, &values)?;
    let model = rival(base, &other_effect, &other_place, &values)?;
    let names = [format!("{effect} at {place}"), format!("{other_effect} at {other_place}")];
    Ok((found, Rival { model, names }))
}

/// A rival with start values: those of parameters that both effects have, else typical ones.
fn rival(base: &Model, effect: &str, place: &str, known: &[(&str, f64)]) -> Result<Model> {
    let catalogue = base
        .effect_with(effect, std::iter::empty())
        .ok_or_else(|| JobError::Inputs(format!("there is no effect {effect}")))?;
    let rotates = base.motion == socam_model::Motion::Rotation;
    let of_file = |name: &str| {
        let law = base.candidate(effect)?;
        let own = law.effect.parameters.iter().position(|own| own.name == name)?;
        Some(base.parameters[law.parameters[own]].value)
    };
    let given = |name: &str| {
        known.iter().find(|(own, _)| *own == name).map(|(_, value)| *value).or_else(|| of_file(name))
    };
    let values: Vec<(&str, f64)> = catalogue
        .parameters
        .iter()
        .filter(|parameter| parameter.default.is_none())
        .map(|parameter| {
            let usual = match parameter.kind.unit(rotates) {
                "N m" | "N" => 0.1,
                "rad/s" | "m/s" => 1.0,
                "rad" | "m" => 0.01,
                "N m/rad" => 1e4,
                "N/m" => 1e6,
                "N m s/rad" | "N s/m" => 0.1,
                "N m s2/rad2" | "kg m2" => 1e-3,
                "Hz" => 1.0,
                "s" => 1e-3,
                "1" if parameter.name == "gain" => 1.0,
                "1" if parameter.name == "order" => 1.0,
                "1" => 0.03,
                _ => 0.01,
            };
            let (low, high) = parameter.bounds;
            (parameter.name, given(parameter.name).unwrap_or(usual).clamp(low, high))
        })
        .collect();
    Ok(base.with_effect(effect, place, &values)?)
}
