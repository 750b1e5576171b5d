//! Why the server cannot run, or a call cannot be made, in one sentence.

use socam_job::JobError;

/// Why the server cannot run, or a call cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum McpError {
    /// No tool has this name.
    #[error("there is no tool `{name}`; the tools are {known}")]
    NoTool {
        /// The name.
        name: String,
        /// Names of all tools.
        known: String,
    },
    /// An argument is missing or has another type.
    #[error("`{name}`: expected {expected}")]
    Argument {
        /// Name of the argument.
        name: String,
        /// What was expected.
        expected: String,
    },
    /// A file to be written lies outside the folder of `--write`.
    #[error("`{path}` does not lie in the folder that may be written: give a path below it, without `..`")]
    Outside {
        /// The path.
        path: String,
    },
    /// An option is unknown or has an invalid value.
    #[error(transparent)]
    Option(#[from] JobError),
    /// The program cannot be started, or the streams of the server fail.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// The client did not begin as the protocol says.
    #[error("the client did not begin as the Model Context Protocol says: {0}")]
    Protocol(String),
}

/// Result with [`McpError`].
pub type Result<T> = std::result::Result<T, McpError>;

impl McpError {
    /// An error of the system.
    pub(crate) fn system(what: impl Into<String>) -> impl FnOnce(std::io::Error) -> Self {
        let what = what.into();
        |source| Self::System { what, source }
    }
}
