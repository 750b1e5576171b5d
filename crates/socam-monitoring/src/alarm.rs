//! Reports of the monitoring: events, alarms and the names of their causes.

use std::fmt;

use serde::Serialize;

/// Quantity that is measured by the test statistic that raised an alarm.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", content = "of", rename_all = "snake_case")]
pub enum Symptom {
    /// Mean of a channel's innovations.
    Level(String),
    /// Power of a channel's innovations.
    Power(String),
    /// Apparent value of a model parameter, by its score.
    Parameter(String),
}

impl Symptom {
    /// Name of the channel or parameter.
    #[must_use]
    pub fn of(&self) -> &str {
        match self {
            Self::Level(name) | Self::Power(name) | Self::Parameter(name) => name,
        }
    }
}

/// `mean error of torque_out`
impl fmt::Display for Symptom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Level(name) => write!(f, "mean error of {name}"),
            Self::Power(name) => write!(f, "power of the error of {name}"),
            Self::Parameter(name) => write!(f, "apparent value of {name}"),
        }
    }
}

/// A change of the bench relative to its model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Alarm {
    /// Number of the alarm, from 1.
    pub number: usize,
    /// Time of the sample at which the alarm was raised, s.
    pub time_s: f64,
    /// Estimated time of the change, s; no finer than a block.
    pub onset_s: f64,
    /// The statistic with the largest excess over its threshold.
    pub symptom: Symptom,
    /// Output channel whose innovations changed most.
    pub channel: String,
    /// Change of the statistic's mean since the onset, in standard deviations of one healthy block.
    pub size_sigma: f64,
    /// Causes, once they were sought: see [`Event::Named`].
    pub naming: Option<Naming>,
}

/// Whether a cause could be named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// One cause explains the change better than all others.
    Named,
    /// Several causes explain it equally well.
    Tied,
    /// No cause explains it.
    Unnamed,
}

/// Possible causes of a change.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Naming {
    /// Whether one cause stands out.
    pub verdict: Verdict,
    /// Start and end of the samples that were used, s.
    pub window_s: [f64; 2],
    /// Causes, the likeliest first.
    pub causes: Vec<Cause>,
}

/// A possible cause of a change: an effect of the catalogue at a place, or a change of a parameter of the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cause {
    /// Id of the effect, or `parameter`.
    pub effect: String,
    /// Place of the effect, or name of the parameter.
    pub location: String,
    /// Names and values of its amplitude, SI, by the linearised prediction: orders of magnitude for large changes. For a parameter: its
    /// value.
    pub amplitude: Vec<(String, f64)>,
    /// Decrease of the sum of squared innovations that it predicts, in units of noise.
    pub gain: f64,
    /// Family-wise p-value of its score test.
    pub p_value: f64,
    /// Share among all causes by likelihood, 1.
    pub share: f64,
}

/// An event at a sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// The beginning of the samples was taken as the baseline.
    Learned(Summary),
    /// A change was detected.
    Alarm(Alarm),
    /// Causes of the alarm were sought over the window after its change.
    Named(Alarm),
    /// The statistics are back within the baseline: a further change will raise an alarm again.
    Returned {
        /// Number of the alarm that has ended.
        number: usize,
        /// Time, s.
        time_s: f64,
    },
}

/// Amount of healthy data in a baseline, and the false alarm rate that it supports.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Length of the healthy samples that were used, s.
    pub healthy_s: f64,
    /// Number of blocks.
    pub blocks: usize,
    /// Number of statistics that are tested.
    pub statistics: usize,
    /// Rate of false alarms that the thresholds are set for, 1/h.
    pub false_alarms_per_hour: f64,
    /// Lowest rate that this length of healthy samples shows directly (one alarm in its length), 1/h. Lower rates rest on the shape of the
    /// statistics' distribution beyond what was seen.
    pub observed_down_to_per_hour: f64,
    /// Whether the baseline is too short for the rate: its thresholds rest on fewer than
    /// [`Baseline::FEW`](crate::Baseline::FEW) blocks.
    pub is_short: bool,
}
