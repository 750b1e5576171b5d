//! Lines and cells of CSV files.

use std::collections::HashSet;
use std::io::{BufReader, Read, SeekFrom};
use std::path::{Path, PathBuf};

use csv::ByteRecord;

use crate::error::{RecordingError, Result, excerpt};
use crate::files::{self, File};
use crate::line_problem::LineProblem;
use crate::part::Place;

/// Bytes asked from the system at a time.
const BUFFER_BYTES: usize = 1 << 18;

/// Most columns of a file.
const MOST_COLUMNS: usize = 10_000;

/// Lines of a CSV file with a header, with their line numbers.
pub(crate) struct CsvLines {
    path: PathBuf,
    reader: csv::Reader<BufReader<File>>,
    /// Length of the byte order mark before the first line.
    skipped: u64,
    /// Number of cells in every line; set by the header.
    pub(crate) cells: usize,
    /// The line last read.
    pub(crate) record: ByteRecord,
    /// Number of the line in the file, from 1.
    pub(crate) line: u64,
}

impl CsvLines {
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let (file, _) = files::open(path).map_err(|e| RecordingError::io(path, "open", e))?;
        let mut file = BufReader::with_capacity(BUFFER_BYTES, file);
        let skipped = skip_byte_order_mark(&mut file).map_err(|e| RecordingError::io(path, "read", e))?;
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .buffer_capacity(BUFFER_BYTES)
            .from_reader(file);
        Ok(Self { path: path.into(), reader, skipped, cells: 0, record: ByteRecord::new(), line: 0 })
    }

    /// The place of the next line.
    pub(crate) fn place(&self) -> Place {
        let position = self.reader.position();
        Place { byte: position.byte(), line: position.line() }
    }

    /// Continues at a place of this file.
    pub(crate) fn seek(&mut self, place: Place) -> Result<()> {
        let mut position = csv::Position::new();
        position.set_byte(place.byte).set_line(place.line);
        let byte = SeekFrom::Start(self.skipped + place.byte);
        self.reader.seek_raw(byte, position).map_err(|e| match e.into_kind() {
            csv::ErrorKind::Io(e) => RecordingError::io(&self.path, "read", e),
            _ => self.error(LineProblem::NotText),
        })
    }

    /// Reads the header; its first column must be `first`.
    pub(crate) fn header(&mut self, first: &str) -> Result<Vec<String>> {
        self.advance()?;
        let found = self.record.len();
        if found > MOST_COLUMNS {
            return Err(self.error(LineProblem::TooManyColumns { found, most: MOST_COLUMNS }));
        }
        let header: Option<Vec<String>> =
            self.record.iter().map(|cell| Some(std::str::from_utf8(cell).ok()?.trim().to_owned())).collect();
        let header = header.ok_or_else(|| self.error(LineProblem::NotText))?;
        if header.first().is_none_or(|cell| cell != first) {
            let found = excerpt(self.record.get(0).unwrap_or_default());
            return Err(self.error(LineProblem::WrongHeader { found }));
        }
        let mut names = HashSet::new();
        for column in &header {
            if !names.insert(column) {
                return Err(self.error(LineProblem::DuplicateColumn { column: column.clone() }));
            }
        }
        self.cells = header.len();
        Ok(header)
    }

    /// Reads the next line that is not empty; false at the file's end.
    pub(crate) fn next(&mut self) -> Result<bool> {
        if !self.advance()? {
            return Ok(false);
        }
        if self.record.len() != self.cells {
            return Err(self.error(LineProblem::CellCount { found: self.record.len(), expected: self.cells }));
        }
        Ok(true)
    }

    fn advance(&mut self) -> Result<bool> {
        let more = self.reader.read_byte_record(&mut self.record).map_err(|e| match e.into_kind() {
            csv::ErrorKind::Io(e) => RecordingError::io(&self.path, "read", e),
            _ => self.error(LineProblem::NotText),
        })?;
        if let Some(position) = self.record.position() {
            self.line = position.line();
        }
        Ok(more)
    }

    /// An error at the line last read.
    pub(crate) fn error(&self, problem: LineProblem) -> RecordingError {
        RecordingError::line(&self.path, self.line, problem)
    }
}

/// Skips a byte order mark; returns its length.
fn skip_byte_order_mark(file: &mut BufReader<File>) -> std::io::Result<u64> {
    use std::io::BufRead;
    if file.fill_buf()?.starts_with(b"\xef\xbb\xbf") {
        file.read_exact(&mut [0; 3])?;
        return Ok(3);
    }
    Ok(0)
}
