//! What is known of the inputs between their samples.

use serde::Serialize;
use socam_model::{Intersample, Model, ModelError};

/// Source of an input's intersample behaviour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BetweenSource {
    /// The model file or an option states it.
    Stated,
    /// The recordings decide for it: every other behaviour fits worse.
    Data,
    /// The recordings do not tell it from another one. It is usual for the input's quantity, or gained on that and does not stand out from it.
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

/// States in `model` how its inputs behave between their samples, by name, where the recordings decided against what is usual.
pub(crate) fn state<'b>(
    found: impl IntoIterator<Item = (&'b String, &'b Between)>,
    model: &mut Model,
) -> Result<(), ModelError> {
    for (input, between) in found.into_iter().filter(|(_, one)| one.source == BetweenSource::Data) {
        let own = model.inputs().find(|channel| channel.name == *input);
        if own.is_some_and(|channel| channel.intersample() != between.kind) {
            model.set_intersample(input, Some(between.kind))?;
        }
    }
    Ok(())
}
