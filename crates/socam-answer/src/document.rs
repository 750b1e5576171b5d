//! The answer of a diagnosis as its JSON document, `socam.diagnosis/1`: a contract with other people's scripts. Fields may
//! be added, never renamed.
//!
//! All quantities are SI. A number that is not known is `None` (null); one that is not finite is written as null too.

use serde::{Deserialize, Serialize};

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

/// One piece of missing physics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Id in the catalogue, or [`UNEXPLAINED`].
    pub effect: String,
    /// Place or channel at which it acts.
    pub location: String,
    /// Its parameters; those of the strongest where there are several `components`.
    pub parameters: Vec<EffectParameter>,
    /// All orders of an effect that has several, strongest first; empty where there is one.
    pub components: Vec<Component>,
    /// Measured shape of the missing torque or channel error, where there is one.
    pub curve: Option<Curve>,
    /// Where it lives.
    pub region: Region,
    /// Why it is believed.
    pub evidence: FindingEvidence,
    /// What else could be meant, likeliest first, without the finding itself.
    pub rivals: Vec<Rival>,
    /// For a mechanic.
    pub sentence: String,
    /// The law, for an engineer.
    pub equation: String,
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectParameter {
    /// Name in the catalogue.
    pub name: String,
    /// SI; `None` where the data do not determine it.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// 95 % interval, SI; an open end is `None`.
    pub ci95: [Option<f64>; 2],
}

/// One of several orders of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Component {
    /// Its parameters.
    pub parameters: Vec<EffectParameter>,
}

/// What a curve is drawn over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Over {
    /// Speed at the place.
    Speed,
    /// Angle at the place.
    Angle,
    /// Torque through the place.
    Torque,
    /// Time from the start of each recording.
    Time,
    /// Frequency.
    Frequency,
}

/// A measured shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// What `x` is.
    pub over: Over,
    /// SI unit of `x`.
    pub unit: String,
    /// Where it was measured, SI, rising.
    pub x: Vec<f64>,
    /// What is missing there, in `torque_unit`; `None` where nothing was measured.
    pub torque: Vec<Option<f64>>,
    /// Standard error of each `torque`; empty where it is not known.
    #[serde(default)]
    pub torque_std: Vec<Option<f64>>,
    /// SI unit of `torque`: N m, or a channel's unit where the curve is that channel's error.
    #[serde(default)]
    pub torque_unit: String,
}

/// Where a finding lives: ranges that hold four fifths of what the correction takes away (of the misfit, where nothing has a name),
/// on the training recordings; `None` where it is not confined.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// Speed at the place, rad/s.
    pub speed_rad_s: Option<[f64; 2]>,
    /// Torque through the place, N m.
    #[serde(rename = "torque_Nm")]
    pub torque_nm: Option<[f64; 2]>,
    /// Angle of the place within a turn, rad.
    #[serde(default)]
    pub angle_rad: Option<[f64; 2]>,
    /// Frequency, Hz.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: Option<[f64; 2]>,
    /// Time from the start of each recording, s.
    pub time_s: Option<[f64; 2]>,
    /// The same in words.
    pub text: String,
}

/// Why a finding is believed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FindingEvidence {
    /// Chance of as much if nothing were missing, 1.
    pub p_value: Option<f64>,
    /// How much it lowers the whitened chi-square of the training recordings.
    pub chi2_gain: Option<f64>,
    /// How much it lowers the mean squared residual of data that it was not fitted to, in per cent of what exceeds noise.
    pub holdout_gain_percent: Option<f64>,
    /// Share of the misfit that it carries, per cent.
    #[serde(default)]
    pub misfit_percent: Option<f64>,
    /// By how much it raises the predictive log score in cross-validation, and the standard error of that.
    #[serde(default)]
    pub log_score_gain: Option<[f64; 2]>,
    /// By how much it moves the prediction of the channel that it moves most, per cent of that channel's standard deviation.
    #[serde(default)]
    pub moves_percent: Option<f64>,
    /// That channel.
    #[serde(default)]
    pub moves_channel: Option<String>,
    /// Whether that is more than the tolerance.
    #[serde(default)]
    pub material: Option<bool>,
}

/// Another explanation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rival {
    /// Id in the catalogue.
    pub effect: String,
    /// Place or channel.
    pub location: String,
    /// Its probability among the finding and its rivals, 0 to 1.
    pub weight: f64,
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

/// Pairs as a JSON object that keeps their order.
mod in_order {
    use std::{fmt, marker::PhantomData};

    use serde::{
        Deserialize, Deserializer, Serialize, Serializer,
        de::{MapAccess, Visitor},
    };

    pub(super) fn serialize<T: Serialize, S: Serializer>(
        pairs: &[(String, T)],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.collect_map(pairs.iter().map(|(name, value)| (name, value)))
    }

    pub(super) fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<(String, T)>, D::Error> {
        deserializer.deserialize_map(Pairs(PhantomData))
    }

    struct Pairs<T>(PhantomData<T>);

    impl<'de, T: Deserialize<'de>> Visitor<'de> for Pairs<T> {
        type Value = Vec<(String, T)>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("an object")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut pairs = Vec::new();
            while let Some(pair) = map.next_entry()? {
                pairs.push(pair);
            }
            Ok(pairs)
        }
    }
}

#[cfg(test)]
mod tests;
