//! The JSON document of a comparison.

use serde::Serialize;

use crate::{Comparison, sentences};

/// A comparison with its sentences.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Document<'c> {
    /// The comparison.
    #[serde(flatten)]
    pub comparison: &'c Comparison,
    /// The sentences of [`sentences`].
    pub sentences: Vec<String>,
    /// The simulator beside a model file on the same inputs.
    pub model: Option<ModelCheck>,
}

impl<'c> Document<'c> {
    /// The document of a comparison, and of one with a model if that was made.
    #[must_use]
    pub fn new(comparison: &'c Comparison, model: Option<ModelCheck>) -> Self {
        Self { comparison, sentences: sentences(comparison), model }
    }
}

/// A simulator beside a model file on the same inputs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelCheck {
    /// Name of the model.
    pub model: String,
    /// What the comparison says.
    pub sentences: Vec<String>,
    /// The comparison.
    pub comparison: Comparison,
}
