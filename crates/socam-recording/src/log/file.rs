//! The file of a recording, which replaces an older one when its first samples are on the disk, and not before.

use std::fs::{File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::beside::create_beside;
use crate::disk;
use crate::error::{RecordingError, Result};

/// File to which a recording is written. Dropping it removes the file, unless [`LogFile::keep`] or [`LogFile::leave`] was called
/// before.
#[derive(Debug)]
pub(super) struct LogFile {
    path: PathBuf,
    state: State,
}

#[derive(Debug)]
enum State {
    /// Under its own name; without samples until now.
    New,
    /// Beside an older file, which is not touched yet.
    Beside(TempPath),
    /// A file that stays: a recording with samples, or a device.
    Kept,
}

impl LogFile {
    /// Creates a file for a recording at `path`, where there is none, or an older one that it will replace.
    pub(super) fn create(path: &Path, replace: bool) -> Result<(Self, File)> {
        let open = || -> io::Result<(State, File)> {
            match path.metadata() {
                Ok(there) if replace && there.is_file() => {
                    let (file, temporary) = create_beside(path)?.into_parts();
                    Ok((State::Beside(temporary), file))
                }
                Ok(_) if replace => Ok((State::Kept, OpenOptions::new().write(true).open(path)?)),
                _ => Ok((State::New, OpenOptions::new().write(true).create_new(true).open(path)?)),
            }
        };
        let (state, file) = open().map_err(|e| RecordingError::io(path, "create", e))?;
        Ok((Self { path: path.into(), state }, file))
    }

    /// The name that the recording will have.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the file stays.
    pub(super) fn is_kept(&self) -> bool {
        matches!(self.state, State::Kept)
    }

    /// Syncs the name that the file has now.
    pub(super) fn sync_name(&self) -> Result<()> {
        disk::sync_name(&self.path).map_err(|e| RecordingError::io(&self.path, "sync the folder of", e))
    }

    /// Puts the file under its own name, in place of an older one, and keeps it. Its content must be on the disk.
    pub(super) fn keep(&mut self) -> Result<()> {
        let State::Beside(temporary) = std::mem::replace(&mut self.state, State::Kept) else { return Ok(()) };
        disk::replace(temporary, &self.path).map_err(|e| {
            let reason = e.error;
            let left = e.path.keep().unwrap_or_default();
            let text = format!("{reason}; what was recorded is in `{}`", left.display());
            RecordingError::io(&self.path, "replace", io::Error::other(text))
        })?;
        self.sync_name()
    }

    /// Keeps the file under the name that it has now, and an older one too; returns that name.
    pub(super) fn leave(&mut self) -> PathBuf {
        match std::mem::replace(&mut self.state, State::Kept) {
            State::Beside(temporary) => temporary.keep().unwrap_or_else(|e| e.path.to_path_buf()),
            State::New | State::Kept => self.path.clone(),
        }
    }
}

impl Drop for LogFile {
    fn drop(&mut self) {
        if matches!(self.state, State::New) {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}
