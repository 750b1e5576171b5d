//! What is known of the inputs between their samples.

use serde::Serialize;
use socam_model::Intersample;

/// Source of an input's intersample behaviour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BetweenSource {
    /// The model file or an option states it.
    Stated,
    /// The recordings decide for it: every other behaviour fits worse.
    Data,
    /// The recordings do not tell it from another one, and it is usual for the input's quantity.
    Usual,
}

/// Behaviour of one input between its samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Between {
    /// The behaviour taken.
    pub kind: Intersample,
    /// Its source.
    pub source: BetweenSource,
    /// The other behaviour that fits best; `None` where none was tried.
    pub rival: Option<Intersample>,
    /// Deviance of the rival minus that of the behaviour taken: -2 times the difference of the log-likelihoods, in units of the misfit.
    pub rival_deviance: Option<f64>,
}
