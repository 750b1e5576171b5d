//! The document of `identify --json` as the window reads it.

use std::collections::BTreeMap;

use serde::Deserialize;

/// Schema of the document.
pub const SCHEMA: &str = "socam.identification/1";

/// The fields of the document that are shown.
#[derive(Debug, Clone, Deserialize)]
pub struct Identification {
    /// Method id.
    pub method: String,
    /// Model name.
    pub model: String,
    /// Recordings used.
    #[serde(default)]
    pub recordings: Vec<String>,
    /// Whether the estimate is a minimum.
    pub converged: bool,
    /// All parameters.
    pub parameters: Vec<Parameter>,
    /// Combinations of parameters that are determined.
    #[serde(default)]
    pub combinations: Vec<Parameter>,
    /// Fit of the model.
    pub fit: Fit,
    /// Fits of recordings that were not fitted.
    #[serde(default)]
    pub validation: Vec<Validation>,
    /// Advice for parameters that are not determined.
    #[serde(default)]
    pub advice: Vec<String>,
    /// Anything a careful reader should know.
    #[serde(default)]
    pub warnings: Vec<String>,
}

/// One parameter or combination.
#[derive(Debug, Clone, Deserialize)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// SI; `None` where the data do not determine it.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// 95 % interval; an open end is `None`.
    #[serde(default)]
    pub ci95: [Option<f64>; 2],
    /// Whether the data determine it; absent for combinations.
    #[serde(default)]
    pub identifiable: Option<bool>,
    /// `data`, `prior` or `fixed`.
    #[serde(default)]
    pub source: String,
    /// Parameters that are strongly correlated with it.
    #[serde(default)]
    pub determined_with: Vec<String>,
    /// Formula in terms of parameters, for combinations.
    #[serde(default)]
    pub expression: String,
    /// Reason why the parameter is not determined, or another remark.
    #[serde(default)]
    pub note: String,
}

/// Fit of a recording that was not fitted.
#[derive(Debug, Clone, Deserialize)]
pub struct Validation {
    /// Name of the recording.
    pub recording: String,
    /// Fit of the prediction.
    pub fit: Fit,
}

/// Fit of all channels.
#[derive(Debug, Clone, Deserialize)]
pub struct Fit {
    /// Fit by channel name.
    pub channels: BTreeMap<String, ChannelFit>,
}

/// Fit of one channel.
#[derive(Debug, Clone, Deserialize)]
pub struct ChannelFit {
    /// Root mean square residual, SI.
    #[serde(deserialize_with = "or_nan")]
    pub rms: f64,
    /// Level by which the residuals were weighted, SI.
    #[serde(deserialize_with = "or_nan")]
    pub noise_std: f64,
    /// Noise of the sensor, SI; `None` in results of earlier versions, and where it is not known.
    #[serde(default)]
    pub sensor_noise_std: Option<f64>,
    /// Variance accounted for, per cent.
    #[serde(deserialize_with = "or_nan")]
    pub vaf_percent: f64,
}

impl ChannelFit {
    /// Noise of the sensor as far as it is known, SI: without what the model leaves beyond it.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.sensor_noise_std.map_or(self.noise_std, |std| std.min(self.noise_std))
    }
}

/// A number; a channel without measurements has none.
fn or_nan<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

/// Text on what is known of a parameter besides its value.
#[must_use]
pub fn known(parameter: &Parameter) -> String {
    if parameter.source == "fixed" {
        return "known beforehand".into();
    }
    if !parameter.expression.is_empty() {
        return format!("= {}", parameter.expression);
    }
    if parameter.value.is_none() {
        let note = if parameter.note.is_empty() { "not determined" } else { &parameter.note };
        let with = &parameter.determined_with;
        return if with.is_empty() || note.contains(with[0].as_str()) {
            note.to_owned()
        } else {
            format!("{note}; together with {}", with.join(", "))
        };
    }
    parameter.note.clone()
}
