//! What can be wrong with a model.

use thiserror::Error;

/// A model that cannot be used, in one sentence that says where and what to do.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// The file is not the TOML that was expected.
    #[error("line {line}: {message}")]
    File {
        /// One-based line in the model file.
        line: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// The network has no unique motion.
    #[error("{0}")]
    Network(String),
    /// A parameter value outside what physics allows.
    #[error("parameter {name} is {value}, but it must be {expected}")]
    Value {
        /// Parameter name.
        name: String,
        /// Offending value in SI.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
}
