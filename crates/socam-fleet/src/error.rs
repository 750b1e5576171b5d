//! Errors of whole runs. What is wrong with one recording is in its row.

use std::io;
use std::path::{Path, PathBuf};

use socam_diagnose::DiagnoseError;
use thiserror::Error;

/// Why a table, a list or a reference cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FleetError {
    /// A file or folder cannot be read or written.
    #[error("cannot {action} `{path}`: {source}")]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Action that failed.
        action: &'static str,
        /// The system's answer.
        source: io::Error,
    },
    /// A list of recordings is not one.
    #[error("`{path}`: {problem}")]
    List {
        /// Path of the file.
        path: PathBuf,
        /// Explanation: what is wrong, and what is expected.
        problem: String,
    },
    /// Rows cannot become columns, or columns rows.
    #[error("rows and columns of the fleet's table do not agree: {0}")]
    Columns(#[from] serde_arrow::Error),
    /// A Parquet file cannot be written or read.
    #[error("`{path}` is no table of a fleet that can be used: {problem}")]
    Table {
        /// Path of the file.
        path: PathBuf,
        /// Explanation of what is wrong.
        problem: String,
    },
    /// Parts that are merged were made with other models, options or versions.
    #[error(
        "`{path}` was made with another {what} than the parts before it; rows are compared only where all were made alike"
    )]
    Unlike {
        /// Path of the part.
        path: PathBuf,
        /// Kind of difference.
        what: String,
    },
    /// The part file is written by another process.
    #[error("`{path}` is in use: another run writes the same table")]
    InUse {
        /// Path of the file.
        path: PathBuf,
    },
    /// A reference recording cannot be used.
    #[error("the reference recording `{recording}` cannot be used: {message}")]
    Reference {
        /// Name of the recording.
        recording: String,
        /// Why.
        message: String,
    },
    /// A recording cannot be screened.
    #[error(transparent)]
    Diagnose(#[from] DiagnoseError),
}

impl FleetError {
    pub(crate) fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Self::Io { path: path.into(), action, source }
    }

    pub(crate) fn table(path: &Path, problem: impl std::fmt::Display) -> Self {
        Self::Table { path: path.into(), problem: problem.to_string() }
    }
}

/// Result of this crate.
pub type Result<T> = std::result::Result<T, FleetError>;
