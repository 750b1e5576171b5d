//! Why a model is not exported.

use thiserror::Error;

/// Why a model is not exported: one sentence.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ExportError {
    /// Nothing of the model's motion would be right in the target.
    #[error("{target} cannot hold the motion of this model: {why}")]
    NoMotion {
        /// Name of the target.
        target: &'static str,
        /// The part that is missing.
        why: String,
    },
    /// A law has no formula.
    #[error("{effect} at {place} has no formula that could be exported")]
    NoFormula {
        /// Id of the effect.
        effect: String,
        /// Name of the place.
        place: String,
    },
    /// The XML writer failed.
    #[error("the file cannot be written: {0}")]
    Xml(String),
}
