//! The file of a log: it grows by whole records only, counts its bytes, and can be truncated to its last whole record.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};

use crate::disk;

/// A file with a buffer in memory. Only a flush writes, so flushing between records leaves whole records.
#[derive(Debug)]
pub(crate) struct LogSink {
    file: File,
    held: Vec<u8>,
    written: u64,
    failed: bool,
}

impl LogSink {
    pub(crate) fn new(file: File) -> Self {
        Self { file, held: Vec::new(), written: 0, failed: false }
    }

    /// Number of bytes written to the operating system.
    pub(crate) fn written(&self) -> u64 {
        self.written
    }

    /// A second handle of the same file, for syncing it while the log's writer holds this one.
    pub(crate) fn handle(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    fn hand_over(&mut self) -> io::Result<()> {
        if self.held.is_empty() {
            return Ok(());
        }
        if let Err(e) = disk::append(&self.file, &self.held) {
            // A partial record is truncated.
            disk::truncate(&self.file, self.written);
            self.failed = true;
            return Err(e);
        }
        self.written += self.held.len() as u64;
        self.held.clear();
        Ok(())
    }

    /// After a failure nothing more is written: an index must not name records that are missing.
    fn check(&self) -> io::Result<()> {
        if self.failed {
            return Err(io::Error::other("writing failed before"));
        }
        Ok(())
    }
}

impl Write for LogSink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.check()?;
        self.held.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.check()?;
        self.hand_over()
    }
}

impl Seek for LogSink {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        let here = self.written + self.held.len() as u64;
        match position {
            SeekFrom::Current(0) => Ok(here),
            SeekFrom::Start(start) if start == here => Ok(here),
            _ => Err(io::Error::other("a log is only written forwards")),
        }
    }
}
