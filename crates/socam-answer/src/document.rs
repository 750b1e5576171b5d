//! The answer of a diagnosis as its JSON document, `socam.diagnosis/1`: a contract with other people's scripts. Fields may
//! be added, never renamed.
//!
//! All quantities are SI. A number that is not known is `None` (null); one that is not finite is written as null too.

mod finding;
mod in_order;

use serde::{Deserialize, Serialize};

pub use finding::{Component, Curve, EffectParameter, Finding, FindingEvidence, Over, Region, Rival};

/// Version of [`Diagnosis`]' JSON form.
pub const SCHEMA: &str = "socam.diagnosis/1";

/// Effect id of a misfit that has structure but no name.
pub const UNEXPLAINED: &str = "unexplained";

/// Whether physics is missing, what it is, and why that is believed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// [`SCHEMA`].
    pub schema: String,
    /// The answer in one word.
    pub verdict: Verdict,
    /// Share of benches with nothing missing on which something would be found, 1.
    pub false_alarm_rate: f64,
    /// How the correction was tried on data that it was not fitted to.
    pub validation: Validation,
    /// How models were compared among the training recordings: each recording left out in turn, or blocks of them.
    #[serde(default)]
    pub selection: Option<Validation>,
    /// What recordings say that were opened only after the last choice; nothing where none was held out or nothing was found.
    #[serde(default)]
    pub held_out: Option<HeldOut>,
    /// What is missing, strongest first; unique in effect and location.
    pub findings: Vec<Finding>,
    /// How well the model fits before and after the correction.
    pub fit: Fit,
    /// The base model's parameters before and after the correction, in the order of the model.
    pub parameters: Vec<ParameterChange>,
    /// Combinations that the data determine where they do not determine the parameters themselves.
    #[serde(default)]
    pub combinations: Vec<CombinationChange>,
    /// Effects that were looked for and not found.
    pub not_found: Vec<NotFound>,
    /// What to record next, where that would tell rivals apart.
    pub suggested_experiment: Option<SuggestedExperiment>,
    /// Processor time without reading files, s, all threads.
    pub cpu_s: f64,
    /// Anything a careful reader should know.
    pub warnings: Vec<String>,
    /// Name of the base model.
    #[serde(default)]
    pub model: String,
    /// What was read.
    #[serde(default)]
    pub recordings: Vec<RecordingUse>,
    /// Version of the program.
    #[serde(default)]
    pub version: String,
}

/// The answer in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The model explains the recordings down to their noise.
    Adequate,
    /// Physics is missing, and at least some of it has a name.
    MissingPhysics,
    /// Physics is missing, and nothing in the catalogue carries it.
    Unexplained,
}

/// How a correction was tried on data that it was not fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Validation {
    /// On recordings that were named for it.
    Holdout,
    /// On each recording in turn, fitted to the others.
    LeaveOneOut,
    /// On each part of a single recording in turn.
    Blocks,
}

/// What held-out recordings say of the corrected model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// In one word.
    pub outcome: ProofOutcome,
    /// For people.
    pub sentence: String,
}

/// Whether held-out recordings confirm the corrected model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProofOutcome {
    /// They are predicted better than by the base model, and no channel worse.
    Holds,
    /// They are not.
    Failed,
}

/// A recording and what it was used for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordingUse {
    /// Its name as given.
    pub name: String,
    /// Whether it was held out: never fitted, only predicted.
    pub held_out: bool,
    /// Samples used.
    pub samples: u64,
    /// From its first to its last sample, s.
    pub duration_s: f64,
}

/// Fit of all channels.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// By channel name, in the order of the model.
    #[serde(with = "in_order")]
    pub channels: Vec<(String, ChannelFit)>,
}

/// How well a channel is predicted, running free; everything in the channel's SI unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelFit {
    /// Noise floor: what a perfect model would leave.
    pub noise_std: Option<f64>,
    /// Root mean square residual on training recordings, base model.
    pub rms_before: Option<f64>,
    /// The same, with all findings, curves of what has no name included.
    pub rms_after: Option<f64>,
    /// Root mean square residual on data that were not fitted, base model.
    pub holdout_rms_before: Option<f64>,
    /// The same, with all findings.
    pub holdout_rms_after: Option<f64>,
    /// SI unit of all of them.
    #[serde(default)]
    pub unit: String,
}

/// A parameter of the base model before and after the correction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterChange {
    /// Name.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Fitted without the correction; `None` where the data do not determine it.
    pub before: Option<f64>,
    /// Fitted with it, the same as `before` where nothing was corrected; `None` where the data do not determine it.
    pub after: Option<f64>,
    /// 95 % interval of `after`; an open end is `None`.
    pub ci95: [Option<f64>; 2],
    /// 95 % interval of `before`; an open end is `None`.
    #[serde(default)]
    pub ci95_before: [Option<f64>; 2],
    /// Whether the data determine `after`.
    pub identifiable: bool,
    /// Known beforehand and not fitted.
    #[serde(default)]
    pub fixed: bool,
    /// Parameters that it cannot be told apart from.
    #[serde(default)]
    pub determined_with: Vec<String>,
}

/// A combination of parameters before and after the correction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CombinationChange {
    /// Name.
    pub name: String,
    /// In terms of parameters.
    pub expression: String,
    /// SI unit.
    pub unit: String,
    /// Fitted without the correction.
    pub before: Option<f64>,
    /// Fitted with it.
    pub after: Option<f64>,
    /// 95 % interval of `after`; an open end is `None`.
    pub ci95: [Option<f64>; 2],
}

/// An effect that was looked for and not found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NotFound {
    /// Id in the catalogue.
    pub effect: String,
    /// Place or channel.
    pub location: String,
    /// The parameter that measures how strong it is.
    pub parameter: String,
    /// How large that would have had to be to be seen, SI; `None` where these recordings cannot show it at any size.
    pub smallest_detectable: Option<f64>,
    /// SI unit.
    pub unit: String,
}

/// What to record next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SuggestedExperiment {
    /// Name of a built-in profile, or a profile file's text.
    pub profile: String,
    /// What it would tell apart, each as `EFFECT@PLACE`.
    pub tells_apart: Vec<String>,
    /// For whoever stands at the bench.
    pub sentence: String,
}

#[cfg(test)]
mod tests;
