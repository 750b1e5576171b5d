//! The samples in an index file: groups of rows, each with its times and then the values of each column.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// The last bytes of every index file; they change with its format.
pub(super) const MAGIC: [u8; 8] = *b"socamix2";
/// Number of rows in a group of the file: their times, then the values of each column.
pub(super) const GROUP: usize = 1 << 16;

/// The groups of rows in an index file.
#[derive(Debug)]
pub(super) struct Groups {
    /// Threads take turns: reading moves the file's position.
    file: Mutex<File>,
    columns: usize,
}

const fn group_bytes(columns: usize) -> u64 {
    (GROUP * (8 + 4 * columns)) as u64
}

impl Groups {
    pub(super) fn new(file: File, columns: usize) -> Self {
        Self { file: Mutex::new(file), columns }
    }

    /// Times of rows, s; NaN if the file cannot be read any more, so that nothing is drawn.
    pub(super) fn times(&self, rows: Range<usize>) -> Vec<f64> {
        let mut times = Vec::with_capacity(rows.len());
        self.read(0, 8, rows.clone(), |bytes| {
            times.extend(bytes.as_chunks().0.iter().map(|number| f64::from_le_bytes(*number)));
        });
        times.resize(rows.len(), f64::NAN);
        times
    }

    pub(super) fn values(&self, column: usize, rows: Range<usize>) -> Vec<f32> {
        let mut values = Vec::with_capacity(rows.len());
        self.read(GROUP * (8 + 4 * column), 4, rows.clone(), |bytes| {
            values.extend(bytes.as_chunks().0.iter().map(|number| f32::from_le_bytes(*number)));
        });
        values.resize(rows.len(), f32::NAN);
        values
    }

    /// Reads rows of a column that begins `at` bytes after the start of its group.
    fn read(&self, at: usize, size: usize, rows: Range<usize>, mut take: impl FnMut(&[u8])) {
        let mut bytes = Vec::new();
        let mut next = rows.start;
        while next < rows.end {
            let (group, first) = (next / GROUP, next % GROUP);
            let count = (rows.end - next).min(GROUP - first);
            bytes.resize(size * count, 0);
            let offset = group as u64 * group_bytes(self.columns) + (at + size * first) as u64;
            if self.read_at(&mut bytes, offset).is_err() {
                return;
            }
            take(&bytes);
            next += count;
        }
    }

    fn read_at(&self, bytes: &mut [u8], offset: u64) -> io::Result<()> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(offset))?;
        file.read_exact(bytes)
    }
}
