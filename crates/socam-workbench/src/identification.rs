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
    /// Whether the model explains the recordings; `None` for inverse dynamics and in results of earlier versions.
    #[serde(default)]
    pub fit_verdict: Option<Explained>,
    /// Residual of each channel in units of its sensor's noise, where that is known.
    #[serde(default)]
    pub misfit: BTreeMap<String, Option<f64>>,
    /// Effects that the model may leave out, the one that would explain most first.
    #[serde(default)]
    pub suspects: Vec<Suspect>,
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

/// Whether a model explains recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Explained {
    /// To within the noise of the sensors.
    #[serde(rename = "explained")]
    Yes,
    /// At least one channel is left by several times its noise.
    #[serde(rename = "explained_to")]
    InPart,
    /// A channel is left by many times its noise.
    #[serde(rename = "not_explained")]
    No,
    /// No channel has a noise level to compare with.
    NotJudged,
}

/// An effect that a model may leave out.
#[derive(Debug, Clone, Deserialize)]
pub struct Suspect {
    /// Name of the effect in words.
    pub name: String,
    /// Place, or channel.
    pub location: String,
    /// Share of the squares left by the fit that it would explain, 0 to 1.
    #[serde(deserialize_with = "or_nan")]
    pub explains: f64,
}

/// Whether the intervals of an identification can be relied on, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    /// Headline.
    pub title: &'static str,
    /// What it rests on, and what to do.
    pub reason: String,
    /// Whether the model explains the recordings; `None` where nothing says so.
    pub explains: Option<bool>,
}

impl Identification {
    /// Whether the model explains its recordings: only then do its parameters mean what their names say.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let worst = self.misfit.iter().filter_map(|(name, times)| Some((name, (*times)?)));
        let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
        let most = worst.map_or_else(String::new, |(name, times)| {
            format!("Largest residual: {name}, {} times the noise of its sensor.", digits(times))
        });
        let suspect = self.suspects.first().map_or_else(String::new, |one| {
            let share = format!("{:.0} %", 100.0 * one.explains);
            format!(" {} at {} would explain {share} of what is left.", capital(&one.name), one.location)
        });
        let doubt =
            "Parameters have taken up a part of what the model leaves out: Diagnose says what that is.";
        match self.fit_verdict {
            Some(Explained::Yes) => {
                let title = "The model explains these recordings";
                Verdict { title, reason: most, explains: Some(true) }
            }
            Some(Explained::InPart) => {
                let title = "The model explains these recordings only in part";
                Verdict { title, reason: format!("{most}{suspect} {doubt}"), explains: Some(false) }
            }
            Some(Explained::No) => {
                let title = "The model does not explain these recordings";
                Verdict { title, reason: format!("{most}{suspect} {doubt}"), explains: Some(false) }
            }
            not_judged => {
                let why = match not_judged {
                    None => "This result does not compare its residuals with the noise of the sensors.",
                    Some(_) => "The noise of no channel is known.",
                };
                let reason =
                    format!("{why} Intervals hold the scatter of the noise, not what the model leaves out.");
                Verdict {
                    title: "Not judged: whether the model explains these recordings",
                    reason,
                    explains: None,
                }
            }
        }
    }
}

/// Two significant digits.
fn digits(value: f64) -> String {
    if value < 10.0 { format!("{value:.1}") } else { format!("{value:.0}") }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
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

#[cfg(test)]
mod tests {
    use super::*;

    fn with(more: &str) -> Identification {
        let text = format!(
            r#"{{"method":"output-error","model":"m","converged":true,"parameters":[],"fit":{{"channels":{{}}}}{more}}}"#
        );
        serde_json::from_str(&text).unwrap()
    }

    #[test]
    fn intervals_of_a_model_that_does_not_explain_are_doubted() {
        let suspects = r#","suspects":[{"effect":"e","name":"coulomb friction","location":"load_bearing","explains":0.84,"moves":{}}]"#;
        let misfit = r#","misfit":{"torque_in":1.1,"torque_out":2.31,"speed":null}"#;
        let verdict = with(&format!(r#","fit_verdict":"explained_to"{misfit}{suspects}"#)).verdict();
        assert_eq!(
            (verdict.title, verdict.explains),
            ("The model explains these recordings only in part", Some(false))
        );
        let reason = "Largest residual: torque_out, 2.3 times the noise of its sensor. Coulomb friction at load_bearing would explain 84 % of what is left. Parameters";
        assert!(verdict.reason.starts_with(reason), "{}", verdict.reason);
        let verdict = with(r#","fit_verdict":"not_explained""#).verdict();
        assert_eq!(
            (verdict.title, verdict.explains),
            ("The model does not explain these recordings", Some(false))
        );
        assert_eq!(with(&format!(r#","fit_verdict":"explained"{misfit}"#)).verdict().explains, Some(true));
        for nothing in ["", r#","fit_verdict":"not_judged""#] {
            assert_eq!(with(nothing).verdict().explains, None);
        }
    }
}
