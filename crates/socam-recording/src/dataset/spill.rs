//! Columns in a temporary file: a recording too long for memory is decoded once, not on every pass.
//!
//! The file has no name, so it is removed when the process ends in any way. It lies in the folder that `TMPDIR` names, or in
//! `/var/tmp` (`/tmp` is often memory), and takes at most half of the free space there.

use std::fs::File;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::table::{BLOCK_ROWS, Table};

/// Most temporary files at a time: each needs a file handle.
const FILES: usize = 64;

/// Number of temporary files that are open.
static OPEN: AtomicUsize = AtomicUsize::new(0);

/// Bytes of one column of a group of [`BLOCK_ROWS`] rows.
const SLICE_BYTES: usize = 8 * BLOCK_ROWS;

/// Groups of rows, each holding its times, then each column's values.
#[derive(Debug)]
pub(crate) struct Spill {
    file: File,
    stored: usize,
    _handle: Handle,
}

/// Counts a file while it is open.
#[derive(Debug)]
struct Handle;

impl Handle {
    fn new() -> Option<Self> {
        let fits = |open: usize| (open < FILES).then_some(open + 1);
        OPEN.fetch_update(Ordering::Relaxed, Ordering::Relaxed, fits).ok().map(|_| Self)
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        OPEN.fetch_sub(1, Ordering::Relaxed);
    }
}

/// A spill while it is written.
#[derive(Debug)]
pub(crate) struct SpillWriter {
    spill: Spill,
    pending: Table,
    bytes: Vec<u8>,
}

impl SpillWriter {
    /// `None` where there is no room for this many rows.
    pub(crate) fn create(columns: usize, rows: u64) -> Option<Self> {
        let handle = Handle::new()?;
        let folder = folder();
        let stored = 1 + columns;
        let bytes = rows.checked_mul(8 * stored as u64)?;
        if bytes > free_bytes(&folder)? / 2 {
            return None;
        }
        let file = tempfile::tempfile_in(folder).ok()?;
        let spill = Spill { file, stored, _handle: handle };
        Some(Self { spill, pending: Table::with_columns(columns), bytes: Vec::new() })
    }

    pub(crate) fn append(&mut self, rows: &Table) -> io::Result<()> {
        let mut next = 0;
        while next < rows.rows() {
            let end = rows.rows().min(next + BLOCK_ROWS - self.pending.rows());
            self.pending.append_part(rows, next..end);
            next = end;
            if self.pending.rows() == BLOCK_ROWS {
                self.write()?;
            }
        }
        Ok(())
    }

    pub(crate) fn finish(mut self) -> io::Result<Spill> {
        self.write()?;
        Ok(self.spill)
    }

    /// Writes a group; the last one is padded with zeros.
    fn write(&mut self) -> io::Result<()> {
        self.bytes.clear();
        for (index, column) in self.pending.all().enumerate() {
            self.bytes.extend(column.iter().flat_map(|value| value.to_ne_bytes()));
            self.bytes.resize((index + 1) * SLICE_BYTES, 0);
        }
        self.pending.clear();
        self.spill.file.write_all(&self.bytes)
    }
}

impl Spill {
    /// Some rows of one column; the times are column 0, then come the file's channels.
    pub(crate) fn read(&self, column: usize, rows: Range<u64>, bytes: &mut Vec<u8>) -> io::Result<Vec<f64>> {
        let mut values = Vec::with_capacity((rows.end - rows.start) as usize);
        let mut next = rows.start;
        while next < rows.end {
            let (group, first) = (next / BLOCK_ROWS as u64, next % BLOCK_ROWS as u64);
            let count = (rows.end - next).min(BLOCK_ROWS as u64 - first);
            let slice = (group * self.stored as u64 + column as u64) * SLICE_BYTES as u64;
            bytes.resize(8 * count as usize, 0);
            read_at(&self.file, bytes, slice + 8 * first)?;
            let (numbers, _) = bytes.as_chunks();
            values.extend(numbers.iter().map(|number| f64::from_ne_bytes(*number)));
            next += count;
        }
        Ok(values)
    }
}

pub(crate) fn folder() -> PathBuf {
    let large = Path::new("/var/tmp");
    if std::env::var_os("TMPDIR").is_none() && large.is_dir() {
        return large.into();
    }
    std::env::temp_dir()
}

#[cfg(unix)]
fn free_bytes(folder: &Path) -> Option<u64> {
    let system = rustix::fs::statvfs(folder).ok()?;
    system.f_bavail.checked_mul(system.f_frsize)
}

#[cfg(unix)]
fn read_at(file: &File, bytes: &mut [u8], offset: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, offset)
}

/// Other systems cannot read at an offset from several threads, so no temporary file is used there.
#[cfg(not(unix))]
fn free_bytes(_: &Path) -> Option<u64> {
    None
}

#[cfg(not(unix))]
fn read_at(_: &File, _: &mut [u8], _: u64) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
