//! The archive: description, model file, shared library.

use std::{
    fs,
    io::{self, Cursor, Write},
    path::{Path, PathBuf},
};

use zip::{CompressionMethod, ZipWriter, write::SimpleFileOptions};

use crate::{
    description::{description, identifier},
    unit::Unit,
};

/// File name of the shared library on this platform.
pub const LIBRARY: &str = if cfg!(windows) {
    "socam_fmu.dll"
} else if cfg!(target_os = "macos") {
    "libsocam_fmu.dylib"
} else {
    "libsocam_fmu.so"
};

/// A unit that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum FmuError {
    /// The model cannot be a unit.
    #[error("{0}")]
    Model(String),
    /// The shared library.
    #[error("cannot read `{}`: {source}", path.display())]
    Library {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The archive cannot be made.
    #[error("the unit cannot be packed: {0}")]
    Archive(io::Error),
    /// No shared library.
    #[error("`{}` is not there; build it with `cargo build --release -p socam-fmu`", .0.display())]
    NoLibrary(PathBuf),
}

/// The shared library in the folder of a program, or in `deps` below it, where cargo puts what the program was built from.
#[must_use]
pub fn library_beside(program: &Path) -> PathBuf {
    let beside = program.with_file_name(LIBRARY);
    let below = program.with_file_name("deps").join(LIBRARY);
    if !beside.is_file() && below.is_file() { below } else { beside }
}

/// FMI's name of this platform, and the extension of its libraries.
fn platform() -> (String, &'static str) {
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        other => other,
    };
    (format!("{}-{system}", std::env::consts::ARCH), std::env::consts::DLL_EXTENSION)
}

/// The unit of `model_text` as the bytes of its archive, with the shared library at `library` (see [`library_beside`]).
///
/// # Errors
/// [`FmuError`] where the model cannot be a unit, or the library cannot be read.
pub fn unit_bytes(model_text: &str, library: &Path) -> Result<Vec<u8>, FmuError> {
    let unit = Unit::new(model_text).map_err(FmuError::Model)?;
    if !library.is_file() {
        return Err(FmuError::NoLibrary(library.into()));
    }
    let binary = fs::read(library).map_err(|source| FmuError::Library { path: library.into(), source })?;
    let (platform, extension) = platform();
    let name = format!("binaries/{platform}/{}.{extension}", identifier(&unit.model().name));
    let description = description(&unit);
    let entries: [(&str, &[u8]); 3] = [
        ("modelDescription.xml", description.as_bytes()),
        ("resources/model.toml", model_text.as_bytes()),
        (&name, &binary),
    ];
    pack(&entries).map_err(FmuError::Archive)
}

fn pack(entries: &[(&str, &[u8])]) -> io::Result<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, bytes) in entries {
        archive.start_file(*name, options)?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}
