//! Comparison of a recording with the output of a simulator, without a model: where, when, at which speed and frequency they differ.
//!
//! The error of a channel is its measurement minus its simulation. Whether there is one is tested without any knowledge of the sensor's
//! noise: noise is independent of the simulated motion, whatever its spectrum, and an error of a simulator is not. Tests are the coherence
//! of the error with the simulated channel and regressions of it on functions of the simulated motion, whose variances come from blocks of
//! the recording; their levels add up to [`Options::false_alarm_rate`].

pub mod alignment;
mod channel;
mod delay;
mod document;
mod error;
mod estimate;
pub mod lags;
mod laws;
mod pair;
mod regression;
mod spectrum;
mod words;

pub use channel::{ChannelComparison, Drawn, OverSpeed, Period};
pub use document::{Document, ModelCheck};
pub use error::{CompareError, Result};
pub use estimate::Estimate;
pub use laws::Law;
pub use pair::{Pairing, pair, shifted};
pub use words::{number, sentences};

use serde::Serialize;

/// How a comparison is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Probability that a difference is reported for a correct simulation.
    pub false_alarm_rate: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { false_alarm_rate: 0.01 }
    }
}

/// A recording beside a simulation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Always `socam.compare/1`.
    pub schema: &'static str,
    /// Name of the recording.
    pub recording: String,
    /// Name of the simulation.
    pub simulation: String,
    /// `differ` where a channel differs, `agree` where none does, `not_judged` where there is none.
    pub verdict: Verdict,
    /// Probability that a correct simulation gets the verdict `differ`.
    pub false_alarm_rate: f64,
    /// Common span of time, s.
    pub time_s: [f64; 2],
    /// Common rows.
    pub rows: usize,
    /// Channels that are the same in both: inputs of the simulation, which are not compared.
    pub inputs: Vec<String>,
    /// Channels, the largest error beside its signal first.
    pub channels: Vec<ChannelComparison>,
    /// What was left out, and other warnings.
    pub warnings: Vec<String>,
}

/// Whether a simulation differs from a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No error was found.
    Agree,
    /// An error was found in at least one channel.
    Differ,
    /// No channel is an output of both: nothing was compared.
    #[serde(rename = "not_judged")]
    NothingCompared,
}

/// Compares channels that were paired.
#[must_use]
pub fn compare(pairing: &Pairing, options: &Options) -> Comparison {
    let level = options.false_alarm_rate / pairing.channels.len().max(1) as f64;
    let motion = pairing.motion();
    let each =
        pairing.channels.iter().map(|channel| channel::compare(channel, pairing, motion.as_ref(), level));
    let mut channels: Vec<_> = each.collect();
    channels.sort_by(|a, b| b.differs.cmp(&a.differs).then(b.error_share.total_cmp(&a.error_share)));
    let differs = channels.iter().any(|channel| channel.differs);
    let [first, last] =
        [pairing.time_s.first(), pairing.time_s.last()].map(|time| time.copied().unwrap_or(0.0));
    Comparison {
        schema: "socam.compare/1",
        recording: pairing.recording.clone(),
        simulation: pairing.simulation.clone(),
        verdict: match (differs, pairing.channels.is_empty()) {
            (true, _) => Verdict::Differ,
            (false, false) => Verdict::Agree,
            (false, true) => Verdict::NothingCompared,
        },
        inputs: pairing.inputs.iter().map(|input| input.channel.name.clone()).collect(),
        false_alarm_rate: options.false_alarm_rate,
        time_s: [first, last],
        rows: pairing.time_s.len(),
        channels,
        warnings: pairing.warnings.clone(),
    }
}
