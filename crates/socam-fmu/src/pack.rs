//! The archive: description, model file, shared library.

use std::{
    fs::{self, File},
    io::{self, Write},
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
    /// A file.
    #[error("cannot {action} `{}`: {source}", path.display())]
    File {
        /// What was tried.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// No shared library.
    #[error("`{}` is not there; build it with `cargo build --release -p socam-fmu`", .0.display())]
    NoLibrary(PathBuf),
}

/// The shared library in the folder of a program, where cargo builds both.
#[must_use]
pub fn library_beside(program: &Path) -> PathBuf {
    program.with_file_name(LIBRARY)
}

/// FMI's name of this platform, and the extension of its libraries.
fn platform() -> (String, &'static str) {
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        other => other,
    };
    (format!("{}-{system}", std::env::consts::ARCH), std::env::consts::DLL_EXTENSION)
}

/// Writes a unit of `model_text` with the shared library at `library` (see [`library_beside`]). The target is there whole or not at all.
///
/// # Errors
/// [`FmuError`] where the model cannot be a unit, or a file cannot be read or written.
pub fn write_fmu(model_text: &str, library: &Path, target: &Path) -> Result<(), FmuError> {
    let unit = Unit::new(model_text).map_err(FmuError::Model)?;
    if !library.is_file() {
        return Err(FmuError::NoLibrary(library.into()));
    }
    let failed = |action, path: &Path| {
        let path = path.to_owned();
        move |source| FmuError::File { action, path, source }
    };
    let binary = fs::read(library).map_err(failed("read", library))?;
    let part = target.with_extension("fmu.part");
    let (platform, extension) = platform();
    let name = format!("binaries/{platform}/{}.{extension}", identifier(&unit.model().name));
    let entries: [(&str, &[u8]); 3] = [
        ("modelDescription.xml", &description(&unit).into_bytes()),
        ("resources/model.toml", model_text.as_bytes()),
        (&name, &binary),
    ];
    let written = pack(&part, &entries).and_then(|()| fs::rename(&part, target));
    if written.is_err() {
        // The part is of no use; that it cannot be removed changes nothing.
        let _ = fs::remove_file(&part);
    }
    written.map_err(failed("write", target))
}

fn pack(path: &Path, entries: &[(&str, &[u8])]) -> io::Result<()> {
    let mut archive = ZipWriter::new(File::create(path)?);
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, bytes) in entries {
        archive.start_file(*name, options)?;
        archive.write_all(bytes)?;
    }
    archive.finish()?.sync_all()
}
