//! Temporary files beside the file that they will become.

use std::io;
use std::path::Path;

use tempfile::{Builder, NamedTempFile, TempPath};

use crate::error::{RecordingError, Result};

/// An empty file beside a target, with a name of its own, for content that is renamed to the target once it is complete. Dropping it
/// removes it.
///
/// # Errors
/// When it cannot be created; the error names the target.
pub fn temporary_beside(target: &Path) -> Result<TempPath> {
    if target.is_dir() {
        return Err(RecordingError::Directory { path: target.into() });
    }
    let file = create_beside(target).map_err(|e| RecordingError::io(target, "create", e))?;
    Ok(file.into_temp_path())
}

/// Creates `NAME.XXXXXX.part` in the folder of a target `NAME`, with random letters for `XXXXXX`. The name is new: no file is
/// overwritten and no link is followed. It has the rights of any new file.
pub(crate) fn create_beside(target: &Path) -> io::Result<NamedTempFile> {
    let mut prefix = target.file_name().unwrap_or_default().to_owned();
    prefix.push(".");
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty());
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(".part");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder.unwrap_or(Path::new(".")))
}
