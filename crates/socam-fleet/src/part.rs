//! The part file of a run: rows as they are made, kept for a restart.
//!
//! A frame is the length of its row's bytes, their CRC-32, and the bytes (postcard). Frames are only appended; a frame that a crash cut
//! off is dropped at the next start. Rows stay in the file, and only their places are kept in memory.

use std::collections::BTreeMap;
use std::fs::{File, TryLockError};
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crc::{CRC_32_ISO_HDLC, Crc};

use crate::error::{FleetError, Result};
use crate::row::Row;

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// Length and checksum.
const HEAD: usize = 8;
/// Largest row, bytes: a damaged length must not take all memory.
const LARGEST_ROW: usize = 1 << 26;

/// Name and id of a row.
type Key = (String, String);

/// Rows that are done.
#[derive(Debug)]
pub struct Part {
    path: PathBuf,
    file: File,
    /// Offset of each row's bytes, and their number.
    places: BTreeMap<Key, (u64, usize)>,
    end: u64,
}

impl Part {
    /// Opens or creates a part file and takes it for this process.
    ///
    /// # Errors
    /// When it cannot be written, or another process has it.
    pub fn open(path: &Path) -> Result<Self> {
        let mut options = File::options();
        let file = options.read(true).write(true).create(true).truncate(false).open(path);
        let file = file.map_err(|e| FleetError::io(path, "open", e))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(FleetError::InUse { path: path.into() }),
            Err(TryLockError::Error(e)) => return Err(FleetError::io(path, "lock", e)),
        }
        let mut part = Self { path: path.into(), file, places: BTreeMap::new(), end: 0 };
        part.scan().map_err(|e| FleetError::io(path, "read", e))?;
        Ok(part)
    }

    /// Finds the whole frames and drops what follows the last of them.
    fn scan(&mut self) -> std::io::Result<()> {
        let mut reader = BufReader::new(&self.file);
        let mut bytes = Vec::new();
        let (mut end, mut places) = (0, BTreeMap::new());
        while let Some(row) = next(&mut reader, &mut bytes)? {
            places.insert((row.recording, row.id), (end + HEAD as u64, bytes.len()));
            end += (HEAD + bytes.len()) as u64;
        }
        drop(reader);
        self.file.set_len(end)?;
        (self.places, self.end) = (places, end);
        Ok(())
    }

    /// Whether a recording with this id is done.
    #[must_use]
    pub fn holds(&self, recording: &str, id: &str) -> bool {
        self.places.contains_key(&(recording.to_owned(), id.to_owned()))
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Appends a row. The operating system has it afterwards, so that it survives the end of this process.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn append(&mut self, row: &Row) -> Result<()> {
        let fail = |problem: std::io::Error| FleetError::io(&self.path, "write", problem);
        let bytes = postcard::to_extend(row, Vec::new()).map_err(|e| fail(std::io::Error::other(e)))?;
        let mut frame = Vec::with_capacity(HEAD + bytes.len());
        frame.extend((bytes.len() as u32).to_le_bytes());
        frame.extend(CRC.checksum(&bytes).to_le_bytes());
        frame.extend(&bytes);
        self.file.seek(SeekFrom::Start(self.end)).and_then(|_| self.file.write_all(&frame)).map_err(fail)?;
        let key = (row.recording.clone(), row.id.clone());
        self.places.insert(key, (self.end + HEAD as u64, bytes.len()));
        self.end += frame.len() as u64;
        Ok(())
    }

    /// The rows with these names and ids, in order of both.
    pub fn rows<'p>(
        &'p mut self,
        wanted: &'p dyn Fn(&str, &str) -> bool,
    ) -> impl Iterator<Item = Result<Row>> + 'p {
        let Self { path, file, places, .. } = self;
        let wanted = places.iter().filter(|((recording, id), _)| wanted(recording, id));
        wanted.map(move |(_, (offset, length))| {
            let mut bytes = vec![0; *length];
            let read = file.seek(SeekFrom::Start(*offset)).and_then(|_| file.read_exact(&mut bytes));
            read.map_err(|e| FleetError::io(path, "read", e))?;
            postcard::from_bytes(&bytes).map_err(|e| FleetError::io(path, "read", std::io::Error::other(e)))
        })
    }
}

/// The next whole frame's row; `bytes` holds its bytes afterwards. `None` at the end, and where a frame is cut off or damaged.
fn next(reader: &mut impl Read, bytes: &mut Vec<u8>) -> std::io::Result<Option<Row>> {
    let mut head = [0; HEAD];
    if !filled(reader, &mut head)? {
        return Ok(None);
    }
    let [length, checksum] = [&head[..4], &head[4..]]
        .map(|half| half.iter().rev().fold(0_u32, |n, byte| n << 8 | u32::from(*byte)));
    if length as usize > LARGEST_ROW {
        return Ok(None);
    }
    bytes.resize(length as usize, 0);
    if !filled(reader, bytes)? || CRC.checksum(bytes) != checksum {
        return Ok(None);
    }
    Ok(postcard::from_bytes(bytes).ok())
}

/// Whether there were enough bytes.
fn filled(reader: &mut impl Read, bytes: &mut [u8]) -> std::io::Result<bool> {
    match reader.read_exact(bytes) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::tests::full;

    #[test]
    fn rows_survive_a_cut_at_every_byte_of_the_last_frame() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f.parquet.part");
        let row = |id: &str| Row { id: id.into(), ..full() };
        let mut part = Part::open(&path).unwrap();
        assert!(matches!(Part::open(&path), Err(FleetError::InUse { .. })));
        part.append(&row("b")).unwrap();
        let whole = part.end;
        part.append(&row("a")).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let all: Vec<Row> = part.rows(&|_, _| true).map(Result::unwrap).collect();
        assert_eq!(all, [row("a"), row("b")]);
        drop(part);
        for cut in whole as usize..bytes.len() {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let mut part = Part::open(&path).unwrap();
            assert_eq!((part.len(), part.holds(&full().recording, "b")), (1, true), "{cut}");
            part.append(&row("c")).unwrap();
            assert_eq!(part.rows(&|_, id| id == "c").map(Result::unwrap).collect::<Vec<_>>(), [row("c")]);
        }
    }
}
