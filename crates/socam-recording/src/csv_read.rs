//! CSV recordings, streamed: `t_s` first, then one column per channel named with its unit.

use std::io::{BufReader, Read, SeekFrom};
use std::path::{Path, PathBuf};

use csv::ByteRecord;

use crate::Channel;
use crate::dataset::{BLOCK_ROWS, Warning};
use crate::error::{LineProblem, RecordingError, Result, excerpt};
use crate::files::{self, File};
use crate::rows::{EndOfRows, Layout, Part, Place};
use crate::table::Table;

/// Bytes asked from the system at a time.
const BUFFER_BYTES: usize = 1 << 18;

/// Rows streaming from a CSV file.
pub(crate) struct CsvRows {
    lines: CsvLines,
    channels: Vec<Channel>,
    columns: Vec<CsvColumn>,
    warnings: Vec<Warning>,
    previous_s: f64,
}

/// A column that a channel is read from, and what it has held so far.
struct CsvColumn {
    cell: usize,
    numbers: bool,
    /// Line and content of the first text in it.
    text: Option<(u64, String)>,
}

/// Where a table's channels stand in its lines.
#[derive(Debug, Clone)]
pub(crate) struct CsvLayout {
    /// Cells in every line.
    cells: usize,
    /// Cell of each channel.
    channels: Vec<(usize, Channel)>,
}

impl CsvRows {
    /// Reads the header.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let mut lines = CsvLines::open(path)?;
        let header = lines.header("t_s")?;
        let mut named = Vec::new();
        let mut warnings = Vec::new();
        for (cell, column) in header.iter().enumerate().skip(1) {
            match Channel::from_column_name(column) {
                Some(channel) => named.push((cell, channel)),
                None => warnings.push(Warning::ColumnWithoutUnit { column: column.clone() }),
            }
        }
        if named.is_empty() {
            return Err(RecordingError::NoChannels { path: path.into() });
        }
        Ok(Self::new(lines, named, warnings, false))
    }

    /// Reads some of the channels again, from some line on.
    pub(crate) fn resume(path: &Path, layout: &CsvLayout, columns: &[usize], place: Place) -> Result<Self> {
        let mut lines = CsvLines::open(path)?;
        lines.cells = layout.cells;
        lines.seek(place)?;
        let named = columns.iter().map(|column| layout.channels[*column].clone()).collect();
        Ok(Self::new(lines, named, Vec::new(), true))
    }

    fn new(lines: CsvLines, named: Vec<(usize, Channel)>, warnings: Vec<Warning>, numbers: bool) -> Self {
        let column = |(cell, channel)| (CsvColumn { cell, numbers, text: None }, channel);
        let (columns, channels) = named.into_iter().map(column).unzip();
        Self { lines, channels, columns, warnings, previous_s: f64::NEG_INFINITY }
    }

    pub(crate) fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Appends at most `rows` rows; false at the file's end.
    pub(crate) fn read(&mut self, table: &mut Table, rows: usize) -> Result<bool> {
        for _ in 0..rows {
            if !self.lines.next()? {
                return Ok(false);
            }
            self.row(table).map_err(|problem| self.lines.error(problem))?;
        }
        Ok(true)
    }

    /// The next block of rows.
    pub(crate) fn next(&mut self) -> Result<Vec<Part>> {
        let place = self.lines.place();
        let mut table = Table::with_columns(self.channels.len());
        self.read(&mut table, BLOCK_ROWS)?;
        Ok(if table.rows() > 0 {
            vec![Part { place, end_byte: self.lines.place().byte, table }]
        } else {
            Vec::new()
        })
    }

    fn row(&mut self, table: &mut Table) -> Result<(), LineProblem> {
        let record = &self.lines.record;
        let time_s =
            number(&record[0], "t_s")?.ok_or_else(|| LineProblem::MissingTime { column: "t_s".into() })?;
        if time_s <= self.previous_s {
            return Err(LineProblem::TimeNotIncreasing { previous_s: self.previous_s, time_s });
        }
        self.previous_s = time_s;
        table.time_s.push(time_s);
        for ((column, channel), values) in self.columns.iter_mut().zip(&self.channels).zip(&mut table.columns)
        {
            let value = column.take(&record[column.cell], channel, self.lines.line)?;
            values.push(value.unwrap_or(f64::NAN));
        }
        Ok(())
    }

    /// Which columns turned out to be text or empty, in words and by number.
    pub(crate) fn finish(self) -> EndOfRows {
        let mut unusable = Vec::new();
        let mut warnings = self.warnings;
        for (index, (column, channel)) in self.columns.iter().zip(&self.channels).enumerate() {
            if column.numbers {
                continue;
            }
            unusable.push(index);
            let name = channel.column_name();
            warnings.push(match column.text {
                Some(_) => Warning::TextColumn { column: name },
                None => Warning::EmptyColumn { column: name },
            });
        }
        let cells = self.columns.iter().map(|column| column.cell);
        let layout = CsvLayout { cells: self.lines.cells, channels: cells.zip(self.channels).collect() };
        EndOfRows {
            layout: Layout::Csv(layout),
            unusable,
            warnings,
            lost_samples: 0,
            cut: None,
            contents: None,
        }
    }
}

impl CsvColumn {
    /// A cell's number; text is let pass while the column has held nothing else.
    fn take(&mut self, cell: &[u8], channel: &Channel, line: u64) -> Result<Option<f64>, LineProblem> {
        let value = match number(cell, "") {
            Ok(Some(value)) => value,
            Ok(None) => return Ok(None),
            Err(LineProblem::NotANumber { found, .. }) if !self.numbers => {
                self.text.get_or_insert((line, found));
                return Ok(None);
            }
            Err(problem) => return Err(problem.in_column(channel)),
        };
        self.numbers = true;
        match &self.text {
            None => Ok(Some(value)),
            Some((text_line, found)) => Err(LineProblem::MixedColumn {
                column: channel.column_name(),
                found: found.clone(),
                text_line: *text_line,
            }),
        }
    }
}

impl LineProblem {
    fn in_column(mut self, channel: &Channel) -> Self {
        if let Self::NotANumber { column, .. } | Self::NotFinite { column, .. } = &mut self {
            *column = channel.column_name();
        }
        self
    }
}

/// A cell's number, `None` when it is empty.
pub(crate) fn number(cell: &[u8], column: &str) -> Result<Option<f64>, LineProblem> {
    let cell = cell.trim_ascii();
    if cell.is_empty() {
        return Ok(None);
    }
    let parsed = std::str::from_utf8(cell).ok().and_then(|c| c.parse().ok());
    match parsed {
        Some(value) if f64::is_finite(value) => Ok(Some(value)),
        Some(_) => Err(LineProblem::NotFinite { column: column.into(), found: excerpt(cell) }),
        None => Err(LineProblem::NotANumber { column: column.into(), found: excerpt(cell) }),
    }
}

/// Lines of any CSV file with a header, with their numbers.
pub(crate) struct CsvLines {
    path: PathBuf,
    reader: csv::Reader<BufReader<File>>,
    /// Bytes before the first line: a byte order mark.
    skipped: u64,
    cells: usize,
    /// The line last read.
    pub(crate) record: ByteRecord,
    /// Its number in the file, from 1.
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

    /// Where the line that is read next starts.
    pub(crate) fn place(&self) -> Place {
        let position = self.reader.position();
        Place { byte: position.byte(), line: position.line() }
    }

    /// Goes on at a place of this file.
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
        let header: Option<Vec<String>> =
            self.record.iter().map(|cell| Some(std::str::from_utf8(cell).ok()?.trim().to_owned())).collect();
        let header = header.ok_or_else(|| self.error(LineProblem::NotText))?;
        if header.first().is_none_or(|cell| cell != first) {
            let found = excerpt(self.record.get(0).unwrap_or_default());
            return Err(self.error(LineProblem::WrongHeader { found }));
        }
        for (index, column) in header.iter().enumerate() {
            if header[..index].contains(column) {
                return Err(self.error(LineProblem::DuplicateColumn { column: column.clone() }));
            }
        }
        self.cells = header.len();
        Ok(header)
    }

    /// Reads the next line that holds anything; false at the file's end.
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

/// Returns its length.
fn skip_byte_order_mark(file: &mut BufReader<File>) -> std::io::Result<u64> {
    use std::io::BufRead;
    if file.fill_buf()?.starts_with(b"\xef\xbb\xbf") {
        file.read_exact(&mut [0; 3])?;
        return Ok(3);
    }
    Ok(0)
}
