//! Errors, each of one sentence.

use std::path::{Path, PathBuf};

/// The result of this crate.
pub type Result<T, E = ImportError> = std::result::Result<T, E>;

/// Why a file or a mapping is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The system refuses to open or read the file.
    #[error("cannot read `{}`: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file as a whole.
    #[error("`{}` {problem}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Explanation: what is wrong, and what to do.
        problem: String,
    },
    /// One line of a text file.
    #[error("`{}`, line {line}: {problem}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// Explanation: what is wrong, and what to do.
        problem: String,
    },
    /// A file that does not state what its numbers are.
    #[error("`{}` {problem}; `socam-host import {} --propose -o map.toml` writes a mapping to complete, for `import --map map.toml`; `import --accept-guesses` takes what is likeliest", path.display(), path.display())]
    Unstated {
        /// The file.
        path: PathBuf,
        /// Fact that the file does not state, as a verb phrase.
        problem: String,
    },
    /// A mapping.
    #[error(transparent)]
    Mapping(#[from] socam_recording::SettingsError),
    /// The recording that was made.
    #[error(transparent)]
    Recording(#[from] socam_recording::RecordingError),
}

/// The first of many in words, and how many more there are.
pub(crate) fn few<T>(all: &[T], shown: usize, words: impl Fn(&T) -> String) -> String {
    let named: Vec<String> = all.iter().take(shown).map(words).collect();
    let more = all.len().saturating_sub(shown);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", named.join(", "))
}

impl ImportError {
    pub(crate) fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.into(), source }
    }

    pub(crate) fn file(path: &Path, problem: impl Into<String>) -> Self {
        Self::File { path: path.into(), problem: problem.into() }
    }

    /// A damaged file, and what its reader says, as one sentence.
    pub(crate) fn damaged(path: &Path, error: impl std::fmt::Display) -> Self {
        let said = error.to_string().replace(['\n', '\r'], " ").replace(". ", ": ");
        Self::file(
            path,
            format!("is damaged or cut off: {}; copy it again from its source", said.trim_end_matches('.')),
        )
    }

    pub(crate) fn line(path: &Path, line: usize, problem: impl Into<String>) -> Self {
        Self::Line { path: path.into(), line, problem: problem.into() }
    }
}
