//! Errors of sources.

use std::path::Path;

use socam_recording::SettingsError;

/// Result of this crate.
pub type Result<T, E = SourceError> = std::result::Result<T, E>;

/// Why a device cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SourceError {
    /// A mistake in a description file.
    #[error(transparent)]
    Description(#[from] SettingsError),
    /// What the device sends cannot be understood.
    #[error("{0}")]
    Foreign(String),
    /// The device does not state everything.
    #[error("the device does not state {unknown}")]
    Unstated {
        /// What it does not state, in words.
        unknown: String,
    },
}

impl SourceError {
    /// Adds the path of the file in which a mistake is.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Description(error) => error.in_file(path).into(),
            other => other,
        }
    }
}
