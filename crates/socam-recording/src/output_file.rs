//! Output files that are written completely or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::beside::create_beside;
use crate::disk;
use crate::error::{RecordingError, Result};

/// A file that is written as `NAME.XXXXXX.part` in the same folder, with random letters for `XXXXXX`, and renamed by
/// [`OutputFile::commit`]; dropping it before removes it. A target that is not a regular file (a pipe, a terminal) is written directly.
///
/// ```
/// use std::io::Write;
///
/// use socam_recording::OutputFile;
///
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("report.html");
/// let mut file = OutputFile::create(&path)?;
/// file.write_all(b"<p>done</p>").unwrap();
/// assert!(!path.exists() && file.temporary().unwrap().exists());
/// file.commit()?;
/// assert_eq!(std::fs::read(&path).unwrap(), b"<p>done</p>");
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
#[derive(Debug)]
pub struct OutputFile {
    target: PathBuf,
    temporary: Option<TempPath>,
    file: BufWriter<File>,
}

impl OutputFile {
    /// Starts a file that will replace `target`.
    ///
    /// # Errors
    /// When it cannot be created.
    pub fn create(target: &Path) -> Result<Self> {
        let fail = |e| RecordingError::io(target, "create", e);
        let special = match target.metadata() {
            Ok(there) if there.is_dir() => {
                return Err(fail(io::ErrorKind::IsADirectory.into()));
            }
            Ok(there) => !there.is_file(),
            Err(_) => false,
        };
        if special {
            let file = File::options().write(true).open(target).map_err(fail)?;
            return Ok(Self { target: target.into(), temporary: None, file: BufWriter::new(file) });
        }
        let (file, temporary) = create_beside(target).map_err(fail)?.into_parts();
        Ok(Self {
            target: target.into(),
            temporary: Some(temporary),
            file: BufWriter::with_capacity(1 << 18, file),
        })
    }

    /// A second handle of the file, for a writer with its own buffer.
    pub(crate) fn handle(&self) -> Result<File> {
        self.file.get_ref().try_clone().map_err(|e| self.fail(e))
    }

    /// Path of the content until it is committed; `None` where the target is written directly.
    #[must_use]
    pub fn temporary(&self) -> Option<&Path> {
        self.temporary.as_deref()
    }

    /// Syncs the content to the disk, renames the file, and syncs its name.
    ///
    /// # Errors
    /// When the content could not be written; no file is left then. When only the name could not be synced, the file is there, and a loss
    /// of power may still undo the renaming.
    pub fn commit(mut self) -> Result<()> {
        self.file.flush().map_err(|e| self.fail(e))?;
        let Some(temporary) = self.temporary.take() else {
            return Ok(());
        };
        disk::sync(self.file.get_ref()).map_err(|e| self.fail(e))?;
        disk::replace(temporary, &self.target).map_err(|e| self.fail(e.error))?;
        disk::sync_name(&self.target).map_err(|e| self.fail(e))
    }

    fn fail(&self, e: io::Error) -> RecordingError {
        RecordingError::io(&self.target, "write to", e)
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
