//! The JSON document of a diagnosis, `socam.diagnosis/1`: a public contract. Fields may be added, but not renamed.
//!
//! All quantities are SI. Unknown and non-finite numbers are `None` (null).

mod answer;
mod candidate;
mod finding;
mod in_order;
mod overlay;

use serde::{Deserialize, Serialize};

pub use answer::{AnswerNode, Level};
pub use candidate::{CandidateFate, Stage, Trial};
pub use finding::{
    Component, Curve, Drag, EffectParameter, Finding, FindingEvidence, Over, Region, Rival, RivalFormula,
};
pub use overlay::Overlay;

/// Version of [`Diagnosis`]' JSON form.
pub const SCHEMA: &str = "socam.diagnosis/1";

/// Effect id of a structured misfit that no effect of the catalogue explains.
pub const UNEXPLAINED: &str = "unexplained";

/// A diagnosis: whether physics is missing, which, and the evidence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// [`SCHEMA`].
    pub schema: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Whether the search came to its own end. Otherwise more may be missing than was found.
    #[serde(default = "completed")]
    pub finished: bool,
    /// What ended the search.
    #[serde(default)]
    pub end: SearchEnd,
    /// When and by what the search was ended before its own end, and what was not examined: a sentence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unfinished: Option<String>,
    /// False alarm rate: share of benches without missing physics on which something would be found, 1.
    pub false_alarm_rate: f64,
    /// Validation of the correction on data that it was not fitted to.
    pub validation: Validation,
    /// Cross-validation among the training recordings: leave one recording out, or blocks.
    #[serde(default)]
    pub selection: Option<Validation>,
    /// Validation on held-out recordings, which are read only after the last choice; until then only their checksums are compared. `None`
    /// if none was held out, or there is no corrected model.
    #[serde(default)]
    pub held_out: Option<HeldOut>,
    /// Findings, strongest first; unique in effect and location.
    pub findings: Vec<Finding>,
    /// The answer as deep as the recordings go: for each finding the nodes that together hold what is missing, see [`crate::answer`]. Empty for
    /// steady states, and in documents of versions before it.
    #[serde(default)]
    pub answer: Vec<AnswerNode>,
    /// Fit of the model before and after the correction.
    pub fit: Fit,
    /// The base model's parameters before and after the correction, in the order of the model.
    pub parameters: Vec<ParameterChange>,
    /// Sizes of the findings that are ordinary imperfections, each named `EFFECT.PARAMETER@PLACE`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ordinary: Vec<ParameterChange>,
    /// Combinations that the data determine although they do not determine the parameters.
    #[serde(default)]
    pub combinations: Vec<CombinationChange>,
    /// Effects that were tested and not found; empty where the search was ended before its own end.
    pub not_found: Vec<NotFound>,
    /// How far each candidate came, those that were asked for first, then the furthest; empty for steady states.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub candidates: Vec<CandidateFate>,
    /// The next experiment, if it would distinguish rivals.
    pub suggested_experiment: Option<SuggestedExperiment>,
    /// Processor time without reading files, s, all threads.
    pub cpu_s: f64,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Name of the base model.
    #[serde(default)]
    pub model: String,
    /// Recordings that were read.
    #[serde(default)]
    pub recordings: Vec<RecordingUse>,
    /// Version of the program.
    #[serde(default)]
    pub version: String,
    /// The first picture; `None` where there are no recordings over time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overlay: Option<Overlay>,
}

impl Diagnosis {
    /// Whether its user ended the search. Its model is then not written anywhere.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        self.end == SearchEnd::Interrupted
    }
}

/// The verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The model explains the recordings down to their noise.
    Adequate,
    /// Physics is missing, and at least some of it has a name.
    MissingPhysics,
    /// Physics is missing, and no effect of the catalogue explains it.
    Unexplained,
    /// The search was ended before anything was found.
    NotJudged,
}

/// What ended the search of a diagnosis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SearchEnd {
    /// No further effect predicts better.
    #[default]
    Completed,
    /// The budget was used up.
    Budget,
    /// The user, for example by Ctrl-C.
    Interrupted,
}

/// A document without the field is of a version whose searches all came to their end.
fn completed() -> bool {
    true
}

/// How a correction was tried on data that it was not fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Validation {
    /// On held-out recordings.
    Holdout,
    /// On each recording in turn, with a fit to the others.
    LeaveOneOut,
    /// On each part of a single recording in turn.
    Blocks,
}

/// Validation of the corrected model on held-out recordings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// Outcome.
    pub outcome: ProofOutcome,
    /// A sentence.
    pub sentence: String,
}

/// Outcome of the validation on held-out recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProofOutcome {
    /// The corrected model predicts them better than the base model, and no channel worse.
    Holds,
    /// The corrected model does not predict them better, or predicts a channel worse.
    Failed,
    /// The held-out recordings could not be used. A warning says why.
    Unusable,
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
    /// Time from its first to its last sample, s.
    pub duration_s: f64,
}

/// Fit of all channels.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// By channel name, in the order of the model.
    #[serde(with = "in_order")]
    pub channels: Vec<(String, ChannelFit)>,
}

/// Fit of a channel by free-run prediction; all values in the channel's SI unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelFit {
    /// Noise floor: residual of a perfect model.
    pub noise_std: Option<f64>,
    /// Root mean square residual on training recordings, base model.
    pub rms_before: Option<f64>,
    /// Root mean square residual on training recordings, model with all findings, including curves of unexplained effects.
    pub rms_after: Option<f64>,
    /// Root mean square residual on data that were not fitted, base model.
    pub holdout_rms_before: Option<f64>,
    /// Root mean square residual on data that were not fitted, model with all findings.
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
    /// Whether its value is known, so that it was not fitted.
    #[serde(default)]
    pub fixed: bool,
    /// Parameters that are strongly correlated with it.
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

/// An effect that was tested and not found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NotFound {
    /// Id in the catalogue.
    pub effect: String,
    /// Place or channel.
    pub location: String,
    /// The parameter that measures its amplitude.
    pub parameter: String,
    /// Smallest detectable value of that parameter, SI; `None` if the recordings cannot show it at any amplitude.
    pub smallest_detectable: Option<f64>,
    /// SI unit.
    pub unit: String,
}

/// The next experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SuggestedExperiment {
    /// Name of a built-in profile, or a profile file's text.
    pub profile: String,
    /// The effects that it would distinguish, each as `EFFECT@PLACE`.
    pub tells_apart: Vec<String>,
    /// Instruction for the operator.
    pub sentence: String,
}

#[cfg(test)]
mod tests;
