//! The row of one recording, `socam.fleet/1`: a public contract. Fields may be added, but not renamed.
//!
//! All quantities are SI. Unknown and non-finite numbers are null. A row holds nothing that depends on the computer, on its load or on the
//! number of workers: the same recording, model, options and version give the same row.

use serde::{Deserialize, Serialize};
pub use socam_diagnose::document::Verdict;

/// Version of the table's form.
pub const SCHEMA: &str = "socam.fleet/1";

/// Whether a recording was diagnosed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The recording has a verdict.
    Ok,
    /// The file cannot be read as a recording.
    Unreadable,
    /// The file is a recording, but this model cannot be fitted to it.
    Unfit,
    /// A computation failed.
    Failed,
}

/// The stage of the cascade at which a row ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Reading the file.
    Read,
    /// The check of channels and excitation.
    Check,
    /// The fit under the frozen noise and the score test.
    ScoreTest,
    /// The full diagnosis.
    Diagnosis,
}

/// One recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// SHA-256 of the recording's bytes, model, options, seed and version, hexadecimal; of the name where the bytes cannot be read.
    pub id: String,
    /// Name of the recording: its path within the fleet's folder, or as the list says.
    pub recording: String,
    /// Serial number of the machine.
    pub machine: Option<String>,
    /// Time at which the recording was made, ms since 1970 (UTC).
    pub date: Option<i64>,
    /// Whether it was diagnosed.
    pub status: Status,
    /// Why not; empty where it was.
    pub message: String,
    /// The stage at which it ended.
    pub stage: Stage,
    /// The verdict.
    pub verdict: Option<Verdict>,
    /// p-value of the screening: chance that a recording of a complete model stands out as much.
    pub p_value: Option<f64>,
    /// Mean square of the whitened residuals in units of the frozen noise, 1.
    pub excess: Option<f64>,
    /// Rows of the recording.
    pub samples: Option<u64>,
    /// Time from its first to its last sample, s.
    pub duration_s: Option<f64>,
    /// Effects that are missing from the model, the strongest first.
    pub findings: Vec<Finding>,
    /// All parameters of the base model, fitted to this recording under the frozen noise, and their combinations: what two springs in series
    /// or the bearings of one drivetrain are together is determined where each of them is not.
    pub parameters: Vec<Parameter>,
    /// Fit of all outputs.
    pub channels: Vec<ChannelFit>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Name of the model.
    pub model: String,
    /// Version of this program.
    pub version: String,
}

/// A piece of missing physics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Id in the catalogue, or `unexplained`.
    pub effect: String,
    /// Place or channel.
    pub place: String,
    /// The parameter that is its size; null where it has none.
    pub parameter: Option<String>,
    /// Value of that parameter, SI.
    pub size: Option<f64>,
    /// Lower end of its 95 % interval.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// SI unit of size and interval.
    pub unit: String,
    /// Greatest change of a channel's prediction, as a share of its standard deviation, 1.
    pub share: Option<f64>,
    /// Whether that exceeds the tolerance.
    pub material: bool,
    /// Increase of the predictive log score in cross-validation.
    pub log_score_gain: Option<f64>,
    /// Standard error of `log_score_gain`.
    pub log_score_std: Option<f64>,
    /// Competing explanations as `EFFECT@PLACE`, most likely first.
    pub rivals: Vec<String>,
    /// A sentence for a mechanic.
    pub sentence: String,
}

impl Finding {
    /// `EFFECT@PLACE`
    #[must_use]
    pub fn key(&self) -> String {
        format!("{}@{}", self.effect, self.place)
    }
}

/// A parameter of the base model, or a combination of parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// Value, SI.
    pub value: Option<f64>,
    /// Standard error.
    pub std: Option<f64>,
    /// Lower end of its 95 % interval.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// Whether the recording determines it.
    pub determined: bool,
}

/// Fit of an output by free-run prediction, in its SI unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelFit {
    /// Name.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Noise level that was used.
    pub noise_std: Option<f64>,
    /// Root mean square residual of the base model.
    pub rms: Option<f64>,
    /// Root mean square residual of the corrected model; null where no diagnosis was made.
    pub rms_corrected: Option<f64>,
}

impl Row {
    /// Machine and, where none is known, the recording as its own machine.
    #[must_use]
    pub fn machine_name(&self) -> &str {
        self.machine.as_deref().unwrap_or(&self.recording)
    }
}

/// A number that may be unknown: null where it is not finite.
pub(crate) fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}
