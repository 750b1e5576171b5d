//! Packing: the archive of description, model file and shared library.

use std::env::consts::{ARCH, DLL_EXTENSION, DLL_PREFIX, DLL_SUFFIX, OS};
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use socam_model::Model;
use zip::{ZipWriter, write::SimpleFileOptions};

use crate::{FmuError, description, variables};

/// The model file within the resources of an FMU.
pub(crate) const MODEL_FILE: &str = "model.toml";

/// The FMU of a model file for the platform of the running program, as the bytes of its archive.
///
/// # Errors
/// [`FmuError::Model`] where the text is no model file, [`FmuError::Unsuited`] where held inputs cannot drive it,
/// [`FmuError::NoLibrary`] where the shared library is not found, [`FmuError::File`] where it cannot be read.
pub fn fmu(model_text: &str) -> Result<Vec<u8>, FmuError> {
    let model = Model::parse(model_text)?;
    let variables = variables(&model, &model.equations(&model.values())?)?;
    let library = library()?;
    let program = std::fs::read(&library).map_err(|source| FmuError::File { path: library, source })?;
    let failed = |source| FmuError::File { path: "the FMU".into(), source };
    let description = description::describe(&model, &variables).map_err(failed)?;
    let binary = format!("binaries/{}/{}.{DLL_EXTENSION}", platform(), description::MODEL_IDENTIFIER);
    let files: [(&str, &[u8]); 3] = [
        ("modelDescription.xml", &description),
        (&format!("resources/{MODEL_FILE}"), model_text.as_bytes()),
        (&binary, &program),
    ];
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        let options = SimpleFileOptions::default().unix_permissions(0o644);
        archive.start_file(name, options).map_err(|error| failed(error.into()))?;
        archive.write_all(bytes).map_err(failed)?;
    }
    Ok(archive.finish().map_err(|error| failed(error.into()))?.into_inner())
}

/// FMI's name of this platform.
fn platform() -> String {
    let system = if OS == "macos" { "darwin" } else { OS };
    format!("{ARCH}-{system}")
}

/// The shared library of this crate: in the folder `deps` beside the running program, where Cargo builds it (what it copies out of there may
/// be older) and archives of releases have it, beside the program, or in `../lib/socam`, where a package of the system installs it. A test lies
/// in `deps` itself, an example in a folder beside it.
///
/// # Errors
/// [`FmuError::NoLibrary`] where it is in none of these folders.
pub fn library() -> Result<PathBuf, FmuError> {
    let name = format!("{DLL_PREFIX}{}{DLL_SUFFIX}", description::MODEL_IDENTIFIER);
    let program = std::env::current_exe().map_err(|source| FmuError::File { path: ".".into(), source })?;
    let folder = program.parent().unwrap_or(Path::new("."));
    let mut folders = vec![folder.join("deps"), folder.into(), folder.join("../lib/socam")];
    if folder.ends_with("examples") {
        folders.insert(0, folder.with_file_name("deps"));
    }
    let found = folders.iter().map(|folder: &PathBuf| folder.join(&name)).find(|path| path.is_file());
    found.ok_or_else(|| FmuError::NoLibrary { name, folder: folder.into() })
}
