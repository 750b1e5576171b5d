//! The one type that everything downstream reads recordings through: channels, units, times, gaps, block by block.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::calibration_file::Calibration;
use crate::csv_read::CsvRows;
use crate::error::{RecordingError, Result};
use crate::format::{self, Format};
use crate::log::read::{LogContents, LogRows};
use crate::segments::{Segment, SegmentFinder};
use crate::selection::{Selection, Span};
use crate::statistics::{Running, Statistics};
use crate::{Channel, legacy};

/// Values kept in memory (64 MiB of them, times included); a longer recording is read again on every pass.
const VALUES_IN_MEMORY: u64 = 8 << 20;

/// Rows read at a time, and the largest number of rows in a block.
const BLOCK_ROWS: usize = 4096;

/// A recording over time, or the selected part of one.
///
/// Opening it reads the file once: every row has been checked, and segments and statistics are known. The samples
/// themselves are then given out by [`Dataset::blocks`] as often as wanted. Short recordings are kept in memory, long ones
/// are read again from the file on each pass; the difference cannot be seen from outside except in time.
///
/// All values are SI. Times are the recording's own (a selection does not shift them) and increase strictly.
#[derive(Debug, Clone)]
pub struct Dataset {
    name: String,
    format: Format,
    channels: Vec<Channel>,
    statistics: Vec<Statistics>,
    segments: Vec<Segment>,
    sample_time_s: f64,
    rows: u64,
    lost_samples: u64,
    cut: Option<Cut>,
    contents: Option<Arc<LogContents>>,
    warnings: Vec<Warning>,
    source: Source,
}

/// Where a recording that was cut off ends, and what is known to be missing.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Cut {
    /// The byte after the last whole record.
    pub byte: u64,
    /// Bytes after it that could not be used.
    pub unused_bytes: u64,
    /// What is missing, in words.
    pub missing: String,
}

/// Something left aside on opening; not an error, but somebody should know.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// A column of text.
    #[error("column `{column}` is text and is left aside")]
    TextColumn {
        /// The column's name.
        column: String,
    },
    /// A column whose name has no unit.
    #[error("column `{column}` names no unit and is left aside (end its name in one of {suffixes})", suffixes = crate::Unit::ALL.map(crate::Unit::suffix).join(" "))]
    ColumnWithoutUnit {
        /// The column's name.
        column: String,
    },
    /// A column that has a unit but not one value.
    #[error("column `{column}` holds no value and is left aside")]
    EmptyColumn {
        /// The column's name.
        column: String,
    },
    /// A recording that was cut off.
    #[error("the recording is cut off: {missing}")]
    CutOff {
        /// What is missing, in words.
        missing: String,
    },
    /// A part of a log that does not fit its checksum.
    #[error("{bytes} damaged bytes at byte {byte} are left out; the samples in them are missing")]
    Damaged {
        /// Where the part starts.
        byte: u64,
        /// Its length, bytes.
        bytes: u64,
    },
    /// Samples that never reached the recording.
    #[error("{samples} samples were lost while recording (by their sequence numbers)")]
    LostSamples {
        /// How many.
        samples: u64,
    },
    /// Anything a reader of one format has to say.
    #[error("{0}")]
    Note(String),
}

#[derive(Debug, Clone)]
enum Source {
    Memory(Arc<Table>),
    File(FileSource),
}

/// How to read the same rows again.
#[derive(Debug, Clone)]
struct FileSource {
    selection: Selection,
    format: Format,
    columns: Vec<usize>,
}

/// Rows of a recording, column by column. A missing value is NaN (readers refuse NaN in files).
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Table {
    pub(crate) time_s: Vec<f64>,
    pub(crate) columns: Vec<Vec<f64>>,
}

impl Table {
    pub(crate) fn with_columns(columns: usize) -> Self {
        Self { time_s: Vec::new(), columns: vec![Vec::new(); columns] }
    }

    pub(crate) fn truncate(&mut self, rows: usize) {
        self.time_s.truncate(rows);
        self.columns.iter_mut().for_each(|c| c.truncate(rows));
    }

    pub(crate) fn clear(&mut self) {
        self.time_s.clear();
        self.columns.iter_mut().for_each(Vec::clear);
    }

    fn append(&mut self, other: &Self) {
        self.time_s.extend_from_slice(&other.time_s);
        for (mine, theirs) in self.columns.iter_mut().zip(&other.columns) {
            mine.extend_from_slice(theirs);
        }
    }

    fn retain_span(&mut self, span: Span) {
        if span == Span::ALL {
            return;
        }
        let start = self.time_s.partition_point(|t| *t < span.from_s);
        let end = self.time_s.partition_point(|t| *t < span.to_s).max(start);
        for column in std::iter::once(&mut self.time_s).chain(&mut self.columns) {
            column.truncate(end);
            column.drain(..start);
        }
    }
}

/// The values of one channel in a [`Block`], in the channel's unit.
///
/// A missing value is held as NaN. Since readers refuse NaN in files, NaN means "missing" and nothing else; ask
/// [`Column::is_complete`] before using [`Column::values`] as plain numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    values: Vec<f64>,
    missing: usize,
}

impl Column {
    fn new(values: Vec<f64>) -> Self {
        let missing = values.iter().filter(|value| value.is_nan()).count();
        Self { values, missing }
    }

    /// One number per row; NaN where the value is missing.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The value at a row of the block, `None` where it is missing (or the row does not exist).
    #[must_use]
    pub fn get(&self, row: usize) -> Option<f64> {
        self.values.get(row).copied().filter(|value| !value.is_nan())
    }

    /// Whether every row has a value.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.missing == 0
    }

    /// Number of rows without a value.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.missing
    }
}

/// Some consecutive rows of a dataset, all in one [`Segment`]: no gap lies inside a block.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Index in [`Dataset::segments`].
    pub segment: usize,
    /// Index of its first row in the dataset, from 0.
    pub first_row: u64,
    /// Times, s, strictly increasing; at least one.
    pub time_s: Vec<f64>,
    /// One column per channel, in the order of [`Dataset::channels`]; each as long as `time_s`.
    pub columns: Vec<Column>,
}

impl Block {
    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.time_s.len()
    }
}

/// All rows of some channels at once, for methods that need them so. See [`Dataset::load`].
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// Times, s, strictly increasing.
    pub time_s: Vec<f64>,
    /// One column per channel asked for, in that order; each as long as `time_s`.
    pub columns: Vec<Column>,
}

impl Dataset {
    /// Opens `RUN` or `RUN@FROM..TO` of any format (told by its content, not its extension).
    ///
    /// # Errors
    /// When the file cannot be read or does not hold a usable recording; each error is one sentence with the place.
    pub fn open(text: &str) -> Result<Self> {
        Self::open_selection(&Selection::parse(text)?)
    }

    /// Opens the selected part of a recording.
    ///
    /// # Errors
    /// As [`Dataset::open`].
    pub fn open_selection(selection: &Selection) -> Result<Self> {
        Self::open_wired(selection, &legacy::Wiring::default())
    }

    /// Opens the selected part of a legacy log, its volts turned into SI by a calibration: the first channel is input 0.
    ///
    /// # Errors
    /// As [`Dataset::open`]; also when it is no legacy log, since only those are in volts, or the calibration has more channels
    /// than the log has inputs.
    pub fn open_calibrated(selection: &Selection, calibration: &Calibration) -> Result<Self> {
        let path = &selection.path;
        if format::detect(path)? != Format::LegacyM {
            return Err(RecordingError::NothingToCalibrate { path: path.clone() });
        }
        let channels = calibration.channels.len();
        if channels > legacy::INPUTS {
            let inputs = legacy::INPUTS;
            return Err(RecordingError::TooManyInputs { path: path.clone(), channels, inputs });
        }
        Self::open_wired(selection, &calibration.into())
    }

    fn open_wired(selection: &Selection, wiring: &legacy::Wiring) -> Result<Self> {
        let path = &selection.path;
        match format::detect(path)? {
            Format::SteadyStates => Err(RecordingError::SteadyStates { path: path.clone() }),
            Format::LegacyM => {
                let log = legacy::LegacyLog::read(path)?;
                let (channels, table) = log.into_table(wiring);
                let mut dataset = Self::from_table(selection.name(), channels, table, selection)?;
                dataset.format = Format::LegacyM;
                Ok(dataset)
            }
            format => Self::scan(selection, format),
        }
    }

    /// A dataset from columns in memory (NaN for a missing value), as simulations and tests make them.
    ///
    /// # Errors
    /// When lengths differ, times do not increase strictly or are not finite, a value is infinite, or there is no row.
    pub fn from_columns(
        name: impl Into<String>,
        channels: Vec<Channel>,
        time_s: Vec<f64>,
        columns: Vec<Vec<f64>>,
    ) -> Result<Self> {
        let name = name.into();
        let problem = |problem: String| Err(RecordingError::Table { name: name.clone(), problem });
        if channels.len() != columns.len() {
            return problem(format!("{} columns for {} channels", columns.len(), channels.len()));
        }
        if let Some(row) = (1..time_s.len()).find(|&row| time_s[row] <= time_s[row - 1]) {
            return problem(format!("time does not increase at row {row}"));
        }
        if time_s.is_empty() || !time_s.iter().all(|t| t.is_finite()) {
            return problem("it needs finite times, at least one".into());
        }
        for (channel, column) in channels.iter().zip(&columns) {
            if column.len() != time_s.len() {
                return problem(format!(
                    "channel `{}` has {} values for {} times",
                    channel.name,
                    column.len(),
                    time_s.len()
                ));
            }
            if column.iter().any(|value| value.is_infinite()) {
                return problem(format!("channel `{}` holds an infinity", channel.name));
            }
        }
        let selection = Selection::whole(&name);
        Self::from_table(name, channels, Table { time_s, columns }, &selection)
    }

    fn from_table(
        name: String,
        channels: Vec<Channel>,
        mut table: Table,
        selection: &Selection,
    ) -> Result<Self> {
        table.retain_span(selection.span);
        let mut tally = Tally::new(channels.len());
        tally.take(&table);
        let (segments, sample_time_s) = tally.finder.finish();
        if segments.is_empty() {
            return Err(RecordingError::NoSamples { path: selection.path.clone() });
        }
        Ok(Self {
            name,
            format: Format::Memory,
            channels,
            statistics: tally.running.into_iter().map(Running::finish).collect(),
            segments,
            sample_time_s,
            rows: table.time_s.len() as u64,
            lost_samples: 0,
            cut: None,
            contents: None,
            warnings: Vec::new(),
            source: Source::Memory(Arc::new(table)),
        })
    }

    /// Reads the file once: checks every row, finds segments and statistics, and keeps the values while they are few.
    fn scan(selection: &Selection, format: Format) -> Result<Self> {
        let mut rows = Rows::open(&selection.path, format, None)?;
        let all_channels = rows.channels().to_vec();
        let mut tally = Tally::new(all_channels.len());
        let mut kept = Some(Table::with_columns(all_channels.len()));
        let mut read = Table::with_columns(all_channels.len());
        loop {
            read.clear();
            let more = rows.read(&mut read, BLOCK_ROWS)?;
            read.retain_span(selection.span);
            tally.take(&read);
            let values = tally.rows * (all_channels.len() as u64 + 1);
            if values > VALUES_IN_MEMORY {
                kept = None;
            }
            if let Some(kept) = &mut kept {
                kept.append(&read);
            }
            if !more {
                break;
            }
        }
        if tally.rows == 0 {
            return Err(RecordingError::NoSamples { path: selection.path.clone() });
        }
        let end = rows.finish();
        Self::assemble(selection, format, &all_channels, tally, kept, end)
    }

    fn assemble(
        selection: &Selection,
        format: Format,
        all_channels: &[Channel],
        tally: Tally,
        kept: Option<Table>,
        end: EndOfRows,
    ) -> Result<Self> {
        let columns: Vec<usize> =
            (0..all_channels.len()).filter(|column| !end.unusable.contains(column)).collect();
        if columns.is_empty() {
            return Err(RecordingError::NoChannels { path: selection.path.clone() });
        }
        let source = match kept {
            Some(mut table) => Source::Memory(Arc::new(Table {
                time_s: table.time_s,
                columns: columns.iter().map(|&column| std::mem::take(&mut table.columns[column])).collect(),
            })),
            None => {
                Source::File(FileSource { selection: selection.clone(), format, columns: columns.clone() })
            }
        };
        let (segments, sample_time_s) = tally.finder.finish();
        Ok(Self {
            name: selection.name(),
            format,
            channels: columns.iter().map(|&c| all_channels[c].clone()).collect(),
            statistics: columns.iter().map(|&c| tally.running[c].finish()).collect(),
            segments,
            sample_time_s,
            rows: tally.rows,
            lost_samples: end.lost_samples,
            cut: end.cut,
            contents: end.contents.map(Arc::new),
            warnings: end.warnings,
            source,
        })
    }

    /// The recording's name in results: the text it was named by.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The format it was read from.
    #[must_use]
    pub fn format(&self) -> Format {
        self.format
    }

    /// Its channels; every block has its columns in this order.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Statistics of each channel, in the order of [`Dataset::channels`].
    #[must_use]
    pub fn statistics(&self) -> &[Statistics] {
        &self.statistics
    }

    /// Uniform stretches in order; a gap lies between each and the next.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Median step of time, s; 0 for a single row.
    #[must_use]
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Time of the first row, s.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.segments.first().map_or(0.0, |segment| segment.start_s)
    }

    /// Time of the last row, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.segments.last().map_or(0.0, |segment| segment.end_s)
    }

    /// Samples that never reached the recording, by their sequence numbers (MCAP only; of the whole file).
    #[must_use]
    pub fn lost_samples(&self) -> u64 {
        self.lost_samples
    }

    /// Where the file was cut off, if it was.
    #[must_use]
    pub fn cut(&self) -> Option<&Cut> {
        self.cut.as_ref()
    }

    /// What an MCAP log holds besides samples; `None` for other formats.
    #[must_use]
    pub fn contents(&self) -> Option<&LogContents> {
        self.contents.as_deref()
    }

    /// What was left aside on opening.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Index of a channel, by its name (`motor_speed`) or, where two share it, by its column's name (`motor_speed_rad_s`).
    ///
    /// # Errors
    /// When there is none of this name, or several.
    pub fn channel_index(&self, name: &str) -> Result<usize> {
        let by_column = self.channels.iter().position(|channel| channel.column_name() == name);
        let mut by_name = (0..self.channels.len()).filter(|&i| self.channels[i].name == name);
        match (by_column, by_name.next(), by_name.next()) {
            (Some(index), _, _) | (None, Some(index), None) => Ok(index),
            _ => Err(RecordingError::NoSuchChannel {
                recording: self.name.clone(),
                channel: name.into(),
                available: self.channels.iter().map(Channel::column_name).collect::<Vec<_>>().join(", "),
            }),
        }
    }

    /// A fresh pass over all rows, in blocks of at most a few thousand rows; may be called any number of times.
    ///
    /// # Errors
    /// When the file can no longer be opened; each block can fail in the same way.
    pub fn blocks(&self) -> Result<Blocks<'_>> {
        let feed = match &self.source {
            Source::Memory(table) => Feed::Memory { table, row: 0 },
            Source::File(file) => Feed::File {
                rows: Box::new(Rows::open(&file.selection.path, file.format, Some(&file.columns))?),
                span: file.selection.span,
                pending: Table::with_columns(self.channels.len()),
                row: 0,
                ended: false,
            },
        };
        Ok(Blocks { dataset: self, feed, next_row: 0, segment: 0 })
    }

    /// All rows of the named channels, in memory. Convenient for short recordings; prefer [`Dataset::blocks`] where a
    /// method can work through a recording of any length.
    ///
    /// # Errors
    /// When a channel does not exist or the file cannot be read again.
    pub fn load(&self, channels: &[&str]) -> Result<Loaded> {
        let indices = channels.iter().map(|name| self.channel_index(name)).collect::<Result<Vec<_>>>()?;
        let mut time_s = Vec::new();
        let mut columns = vec![Vec::new(); indices.len()];
        for block in self.blocks()? {
            let block = block?;
            time_s.extend_from_slice(&block.time_s);
            for (column, &index) in columns.iter_mut().zip(&indices) {
                column.extend_from_slice(block.columns[index].values());
            }
        }
        Ok(Loaded { time_s, columns: columns.into_iter().map(Column::new).collect() })
    }
}

/// What a first pass gathers.
struct Tally {
    finder: SegmentFinder,
    running: Vec<Running>,
    rows: u64,
}

impl Tally {
    fn new(columns: usize) -> Self {
        Self { finder: SegmentFinder::new(), running: vec![Running::new(); columns], rows: 0 }
    }

    fn take(&mut self, table: &Table) {
        table.time_s.iter().for_each(|t| self.finder.push(*t));
        for (running, column) in self.running.iter_mut().zip(&table.columns) {
            column.iter().for_each(|value| running.push(*value));
        }
        self.rows += table.time_s.len() as u64;
    }
}

/// Rows streaming from a file, of one format or another.
pub(crate) enum Rows {
    Csv(Box<CsvRows>),
    Log(Box<LogRows>),
}

/// What a reader knows once it has seen the last row.
#[derive(Debug, Default)]
pub(crate) struct EndOfRows {
    /// Columns that turned out to hold no numbers.
    pub(crate) unusable: Vec<usize>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) lost_samples: u64,
    pub(crate) cut: Option<Cut>,
    pub(crate) contents: Option<LogContents>,
}

impl Rows {
    /// `columns`: which of the file's channels to read; all on the first pass.
    fn open(path: &Path, format: Format, columns: Option<&[usize]>) -> Result<Self> {
        match format {
            Format::Csv => Ok(Self::Csv(Box::new(CsvRows::open(path, columns)?))),
            Format::Mcap => Ok(Self::Log(Box::new(LogRows::open(path, columns)?))),
            _ => Err(RecordingError::Foreign {
                path: PathBuf::from(path),
                found: format!("is {format}, which this version does not read"),
            }),
        }
    }

    fn channels(&self) -> &[Channel] {
        match self {
            Self::Csv(rows) => rows.channels(),
            Self::Log(rows) => rows.channels(),
        }
    }

    /// Appends at most `limit` rows; false once there are no more.
    fn read(&mut self, table: &mut Table, limit: usize) -> Result<bool> {
        match self {
            Self::Csv(rows) => rows.read(table, limit),
            Self::Log(rows) => rows.read(table, limit),
        }
    }

    fn finish(self) -> EndOfRows {
        match self {
            Self::Csv(rows) => rows.finish(),
            Self::Log(rows) => rows.finish(),
        }
    }
}

/// A pass over a dataset. See [`Dataset::blocks`].
pub struct Blocks<'a> {
    dataset: &'a Dataset,
    feed: Feed<'a>,
    next_row: u64,
    segment: usize,
}

enum Feed<'a> {
    Memory {
        table: &'a Table,
        row: usize,
    },
    File {
        rows: Box<Rows>,
        span: Span,
        pending: Table,
        /// Rows of `pending` given out already.
        row: usize,
        ended: bool,
    },
    Failed,
}

impl Blocks<'_> {
    fn next_block(&mut self) -> Result<Option<Block>> {
        let dataset = self.dataset;
        let available = self.available()?;
        if available == 0 {
            return self.check_end();
        }
        let Some(segment) = dataset.segments.get(self.segment) else {
            return Err(self.changed(self.next_row + available as u64));
        };
        let left = (segment.end_row() - self.next_row) as usize;
        let rows = available.min(left).min(BLOCK_ROWS);
        let (table, row) = match &mut self.feed {
            Feed::Memory { table, row } => (&**table, row),
            Feed::File { pending, row, .. } => (&*pending, row),
            Feed::Failed => return Ok(None),
        };
        let range = *row..*row + rows;
        *row += rows;
        let block = Block {
            segment: self.segment,
            first_row: self.next_row,
            time_s: table.time_s[range.clone()].to_vec(),
            columns: table.columns.iter().map(|column| Column::new(column[range.clone()].to_vec())).collect(),
        };
        self.next_row += rows as u64;
        if self.next_row == segment.end_row() {
            self.segment += 1;
        }
        Ok(Some(block))
    }

    /// Rows ready to be given out, reading more when there are none.
    fn available(&mut self) -> Result<usize> {
        match &mut self.feed {
            Feed::Memory { table, row } => Ok(table.time_s.len() - *row),
            Feed::Failed => Ok(0),
            Feed::File { rows, span, pending, row, ended } => {
                while *row == pending.time_s.len() && !*ended {
                    pending.clear();
                    *row = 0;
                    *ended = !rows.read(pending, BLOCK_ROWS)?;
                    // Nothing after the span's end is wanted: a short part of a long file is quick to read.
                    *ended |= pending.time_s.last().is_some_and(|t| *t >= span.to_s);
                    pending.retain_span(*span);
                }
                Ok(pending.time_s.len() - *row)
            }
        }
    }

    fn check_end(&self) -> Result<Option<Block>> {
        if self.next_row == self.dataset.rows || matches!(self.feed, Feed::Failed) {
            return Ok(None);
        }
        Err(self.changed(self.next_row))
    }

    fn changed(&self, found_rows: u64) -> RecordingError {
        RecordingError::Changed {
            path: PathBuf::from(&self.dataset.name),
            expected_rows: self.dataset.rows,
            found_rows,
        }
    }
}

impl Iterator for Blocks<'_> {
    type Item = Result<Block>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.next_block().transpose();
        if let Some(Err(_)) = next {
            self.feed = Feed::Failed;
        }
        next
    }
}
