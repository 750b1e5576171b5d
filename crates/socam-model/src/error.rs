//! Errors of model files and models.

use thiserror::Error;

/// Why a model cannot be used: one sentence with the place and, where one is known, the remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// The model file is not TOML, or an entry is missing, unknown or wrong.
    #[error("line {line}: {message}")]
    File {
        /// One-based line in the model file.
        line: usize,
        /// Explanation: what was found, what was expected, and what to write.
        message: String,
    },
    /// The network has no unique motion, or an element or channel is at a place where it cannot act.
    #[error("{0}")]
    Network(String),
    /// A parameter value for which no equations exist.
    #[error("parameter {name} is {value}, but it must be {expected}")]
    Value {
        /// Parameter name.
        name: String,
        /// Offending value in SI.
        value: f64,
        /// Condition that the value must meet.
        expected: &'static str,
    },
}
