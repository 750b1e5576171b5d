//! Errors of FMUs.

use std::path::PathBuf;

use socam_identify::IdentifyError;
use socam_model::ModelError;
use thiserror::Error;

/// Why an FMU cannot be written or simulated.
#[derive(Debug, Error)]
pub enum FmuError {
    /// The model file cannot be read.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The model cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] IdentifyError),
    /// The model depends on its inputs in a way that held inputs cannot represent.
    #[error("{0}")]
    Unsuited(String),
    /// A call with arguments that the model does not have or that are outside of their limits.
    #[error("{0}")]
    Argument(String),
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The shared library has not been built, or lies elsewhere.
    #[error(
        "the shared library {name} is not in {}; build it with `cargo build --release -p socam-fmu`, or copy it beside the program",
        folder.display()
    )]
    NoLibrary {
        /// File name of the shared library.
        name: String,
        /// Folder of the running program.
        folder: PathBuf,
    },
}
