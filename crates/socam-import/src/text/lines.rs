//! Lines of a text file in its encoding.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use encoding_rs::Encoding;
use encoding_rs_io::{DecodeReaderBytes, DecodeReaderBytesBuilder};

use crate::error::{ImportError, Result};

/// Bytes from which encoding and layout are found.
pub(super) const HEAD_BYTES: u64 = 1 << 16;
/// Longest line, bytes.
const LONGEST_LINE: u64 = 1 << 20;

/// The encoding by a byte order mark; else UTF-8 where the bytes are valid, else Western European.
pub(crate) fn encoding(head: &[u8]) -> &'static Encoding {
    if let Some((encoding, _)) = Encoding::for_bom(head) {
        return encoding;
    }
    match std::str::from_utf8(head) {
        Ok(_) => encoding_rs::UTF_8,
        // The last character may be cut.
        Err(error) if error.error_len().is_none() => encoding_rs::UTF_8,
        Err(_) => encoding_rs::WINDOWS_1252,
    }
}

/// Lines of text with their numbers.
pub(crate) struct Lines<'p> {
    path: &'p Path,
    reader: BufReader<DecodeReaderBytes<File, Vec<u8>>>,
    /// Number of the last line that was read, from 1.
    pub(crate) line: usize,
    /// That line, with its end.
    pub(crate) text: String,
}

impl<'p> Lines<'p> {
    pub(crate) fn open(path: &'p Path, encoding: &'static Encoding) -> Result<Self> {
        let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
        let decoded = DecodeReaderBytesBuilder::new().encoding(Some(encoding)).bom_override(true).build(file);
        Ok(Self { path, reader: BufReader::with_capacity(1 << 18, decoded), line: 0, text: String::new() })
    }

    /// Lines in the encoding that the beginning of the file shows.
    pub(crate) fn sniffed(path: &'p Path) -> Result<Self> {
        let mut head = Vec::new();
        let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
        file.take(HEAD_BYTES).read_to_end(&mut head).map_err(|error| ImportError::io(path, error))?;
        Self::open(path, encoding(&head))
    }

    /// The last line without its end.
    pub(crate) fn bare(&self) -> &str {
        self.text.trim_end_matches(['\r', '\n'])
    }

    /// An error at the last line.
    pub(crate) fn problem(&self, problem: impl Into<String>) -> ImportError {
        ImportError::line(self.path, self.line, problem)
    }

    /// Reads the next line; `false` at the end of the file.
    pub(crate) fn next(&mut self) -> Result<bool> {
        self.text.clear();
        let read = (&mut self.reader).take(LONGEST_LINE).read_line(&mut self.text);
        let read = read.map_err(|error| ImportError::io(self.path, error))?;
        self.line += 1;
        if read as u64 == LONGEST_LINE {
            let problem = format!("is longer than {LONGEST_LINE} bytes; this is no table of numbers");
            return Err(ImportError::line(self.path, self.line, problem));
        }
        Ok(read > 0)
    }
}
