//! A finding of a diagnosis: one piece of missing physics.

use serde::{Deserialize, Serialize};
use socam_plot::words;

/// One piece of missing physics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Id in the catalogue, or [`super::UNEXPLAINED`].
    pub effect: String,
    /// Place or channel at which it acts.
    pub location: String,
    /// Its parameters; those of the strongest where there are several `components`.
    pub parameters: Vec<EffectParameter>,
    /// Of friction at a bearing, what its laws share: the steady torque against the motion at a tenth, half and nine tenths of the largest speed.
    /// Empty for other effects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drag: Vec<Drag>,
    /// All orders of an effect that has several, strongest first; empty where there is one.
    pub components: Vec<Component>,
    /// Measured shape of the missing torque or channel error, where there is one.
    pub curve: Option<Curve>,
    /// Region of speed, torque, angle, frequency and time where it acts.
    pub region: Region,
    /// Evidence.
    pub evidence: FindingEvidence,
    /// Rivals (competing explanations), most likely first, without the finding itself.
    pub rivals: Vec<Rival>,
    /// Laws that contain the finding's law and predict no better by more than that law may be wrong by; their weight is part of the
    /// finding's own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub richer: Vec<Rival>,
    /// Other formulas that were fitted in the place of the `curve`, where `equation` is a formula for it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub formulas: Vec<RivalFormula>,
    /// A sentence for a mechanic.
    pub sentence: String,
    /// The equation of the law.
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

/// Steady torque against the motion of a bearing at a speed, by all laws there and the bearing's damping. Laws of one family differ in
/// their coefficients more than in this.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drag {
    /// The speed.
    pub speed: f64,
    /// SI unit of the speed.
    pub speed_unit: String,
    /// The torque, SI.
    pub torque: f64,
    /// SI unit of the torque.
    pub torque_unit: String,
    /// 95 % interval, SI.
    pub ci95: [Option<f64>; 2],
}

impl Drag {
    /// Its name in a list of parameters: "drag and damping at 1.20 rad/s".
    #[must_use]
    pub fn name(&self) -> String {
        format!("drag and damping at {} {}", words::number(Some(self.speed)), words::unit(&self.speed_unit))
    }
}

/// One of several orders of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Component {
    /// Its parameters.
    pub parameters: Vec<EffectParameter>,
}

/// Horizontal axis of a curve.
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
    /// Positions, SI, ascending.
    pub x: Vec<f64>,
    /// Missing torque or channel error, in `torque_unit`; `None` where nothing was measured.
    pub torque: Vec<Option<f64>>,
    /// Standard error of each `torque`; empty where it is not known.
    #[serde(default)]
    pub torque_std: Vec<Option<f64>>,
    /// SI unit of `torque`: N m, or a channel's unit where the curve is that channel's error.
    #[serde(default)]
    pub torque_unit: String,
}

/// Region where a finding acts: ranges that contain 80 % of the decrease of the misfit on the training recordings (of the misfit itself
/// if it is unexplained); `None` if it is not confined.
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
    /// The region in words.
    pub text: String,
}

/// Evidence for a finding.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FindingEvidence {
    /// p-value: probability of such evidence without missing physics, 1.
    pub p_value: Option<f64>,
    /// Decrease of the whitened chi-square of the training recordings.
    pub chi2_gain: Option<f64>,
    /// Decrease of the mean squared residual of validation data, per cent of its excess over noise.
    pub holdout_gain_percent: Option<f64>,
    /// Share of the misfit that it explains, per cent.
    #[serde(default)]
    pub misfit_percent: Option<f64>,
    /// Increase of the predictive log score in cross-validation, and its standard error.
    #[serde(default)]
    pub log_score_gain: Option<[f64; 2]>,
    /// Greatest change of the prediction of a channel, per cent of that channel's standard deviation.
    #[serde(default)]
    pub moves_percent: Option<f64>,
    /// The channel with the greatest change.
    #[serde(default)]
    pub moves_channel: Option<String>,
    /// Whether that change exceeds the tolerance.
    #[serde(default)]
    pub material: Option<bool>,
    /// Why an imperfection of this size is ordinary: every machine has a little of it, and it counts as no fault.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ordinary: Option<String>,
}

impl Finding {
    /// Whether it says that something is wrong: it moves a channel by more than the tolerance, and its size is not ordinary.
    #[must_use]
    pub fn counts(&self) -> bool {
        self.evidence.material != Some(false) && self.evidence.ordinary.is_none()
    }

    /// Its weight beside its rivals, 0 to 1, that of richer laws included.
    #[must_use]
    pub fn own_weight(&self) -> f64 {
        let others = self.rivals.iter().map(|rival| rival.weight).filter(|weight| weight.is_finite());
        (1.0 - others.sum::<f64>()).clamp(0.0, 1.0)
    }

    /// Its weight without that of richer laws, 0 to 1.
    #[must_use]
    pub fn weight_of_its_law(&self) -> f64 {
        (self.own_weight() - self.richer.iter().map(|law| law.weight).sum::<f64>()).max(0.0)
    }
}

/// A formula that was fitted and not taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RivalFormula {
    /// The formula, over the coordinate of the place; `curve` is the curve itself.
    pub formula: String,
    /// Log score that it predicts less than the one that was taken, and the standard error.
    pub less: [f64; 2],
}

/// A competing explanation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rival {
    /// Id in the catalogue.
    pub effect: String,
    /// Place or channel.
    pub location: String,
    /// Its probability among the finding and its rivals, 0 to 1.
    pub weight: f64,
}
