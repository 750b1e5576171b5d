//! A finding of a diagnosis: one piece of missing physics.

use serde::{Deserialize, Serialize};

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
