//! Records of a binary file, read one after the other, and the numbers in them.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use crate::error::{ImportError, Result, few};

/// Why a file ends before its end: words for an error or a note.
pub(super) type Problem = String;

/// A file that is read in pieces.
pub(super) struct Stream {
    file: BufReader<File>,
    /// Bytes that were read.
    pub(super) at: u64,
    piece: Vec<u8>,
}

impl Stream {
    pub(super) fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
        Ok(Self { file: BufReader::with_capacity(1 << 18, file), at: 0, piece: Vec::new() })
    }

    /// The next bytes; fewer at the end of the file. Memory grows with the bytes that are there, not with those that are announced.
    pub(super) fn up_to(&mut self, count: usize) -> Result<&[u8], Problem> {
        self.piece.clear();
        let read = (&mut self.file).take(count as u64).read_to_end(&mut self.piece);
        self.at += read.map_err(|error| error.to_string())? as u64;
        Ok(&self.piece)
    }

    /// The next bytes, all of them.
    pub(super) fn exactly(&mut self, count: usize) -> Result<&[u8], Problem> {
        let from = self.at;
        let read = self.up_to(count)?.len();
        if read < count {
            return Err(format!("{count} bytes are needed at byte {from}, where {read} are left"));
        }
        Ok(&self.piece)
    }

    /// Goes to a byte of the file.
    pub(super) fn go_to(&mut self, at: u64) -> Result<(), Problem> {
        self.file.seek(SeekFrom::Start(at)).map_err(|error| error.to_string())?;
        self.at = at;
        Ok(())
    }
}

/// Fields of a record, one after the other, the least significant byte first.
pub(super) struct Fields<'b>(pub(super) &'b [u8]);

impl<'b> Fields<'b> {
    pub(super) fn bytes(&mut self, count: usize) -> Option<&'b [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.bytes(N)?.try_into().ok()
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.array().map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn f32(&mut self) -> Option<f32> {
        self.array().map(f32::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// An unsigned number of up to eight bytes.
    pub(super) fn whole(&mut self, bytes: usize) -> Option<u64> {
        let taken = self.bytes(bytes)?;
        let mut wide = [0; 8];
        wide.get_mut(..bytes)?.copy_from_slice(taken);
        Some(u64::from_le_bytes(wide))
    }

    /// A text behind its length.
    pub(super) fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        Some(String::from_utf8_lossy(self.bytes(length)?).into_owned())
    }
}

/// A note on entries that are left aside, the first of them by name; `None` where there are none.
pub(super) fn left_aside(what: &str, names: &[String]) -> Option<socam_recording::Warning> {
    const SHOWN: usize = 8;
    if names.is_empty() {
        return None;
    }
    let names = few(names, SHOWN, |name| format!("`{name}`"));
    Some(socam_recording::Warning::Note(format!("{what} left aside: {names}")))
}
