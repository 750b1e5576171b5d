//! Order of a recorder's operations on its log and file, which determines what is left after a crash of the process or a loss of
//! power.

use std::fs::File;

use super::file::LogFile;
use super::writer::{LogWriter, Topic};
use crate::disk;
use crate::error::{RecordingError, Result};

/// A log on its way to the disk.
///
/// A file is named only after its content is synced, and a name is synced after it is given. So a loss of power leaves an older file or
/// a new one with samples, and never loses what was synced.
pub(super) struct Writing {
    log: LogWriter,
    file: LogFile,
}

impl Writing {
    /// Continues with a log whose header is written, and syncs it: without the header no later sample could be read.
    pub(super) fn begin(log: LogWriter, file: LogFile) -> Result<Self> {
        let mut writing = Self { log, file };
        writing.sync()?;
        writing.file.sync_name()?;
        Ok(writing)
    }

    /// Appends a message to the open chunk, in memory.
    pub(super) fn message(
        &mut self,
        topic: Topic,
        device_time_ns: i64,
        sequence: Option<u64>,
        bytes: &[u8],
    ) -> Result<()> {
        self.log.message(topic, device_time_ns, sequence, bytes)
    }

    /// Hands the open chunk to the operating system, and keeps the file from its first samples on.
    pub(super) fn close_chunk(&mut self) -> Result<()> {
        self.log.flush()?;
        if self.log.samples_flushed() > 0 && !self.file.is_kept() {
            self.sync()?;
            self.file.keep()?;
        }
        Ok(())
    }

    /// Syncs what was handed to the operating system.
    pub(super) fn sync(&mut self) -> Result<()> {
        sync(self.log.file(), &mut self.file, self.log.samples_flushed() > 0)
    }

    /// Number of samples handed to the operating system.
    pub(super) fn samples_flushed(&self) -> u64 {
        self.log.samples_flushed()
    }

    /// Writes the index, and syncs and keeps a file with samples. Returns samples and bytes written.
    pub(super) fn finish(mut self, lost: u64) -> Result<(u64, u64)> {
        let (samples, flushed) = (self.log.samples(), self.log.samples_flushed());
        let (content, bytes) = self.log.finish(lost).map_err(|e| e.after(flushed))?;
        if samples > 0 {
            let kept = sync(&content, &mut self.file, true).and_then(|()| self.file.keep());
            kept.map_err(|e| e.after(samples))?;
        }
        Ok((samples, bytes))
    }
}

/// Syncs a file's content. When that fails, samples stay readable under the name that the file has now.
fn sync(content: &File, file: &mut LogFile, has_samples: bool) -> Result<()> {
    disk::sync(content).map_err(|source| match has_samples {
        true => RecordingError::NotSynced { path: file.leave(), source },
        false => RecordingError::io(file.path(), "sync", source),
    })
}
