//! The one type that everything downstream reads recordings through: channels, units, times, gaps, block by block.

mod block;
mod blocks;
mod keep;
mod regular;
mod scan;
mod spill;
#[cfg(test)]
mod tests;
mod warning;

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

pub use block::{Block, Column, Loaded};
pub use blocks::Blocks;
pub use regular::{Carry, Steps};
pub use warning::{Cut, Warning};

use crate::calibration_file::Calibration;
use crate::error::{RecordingError, Result};
use crate::format::{self, Format};
use crate::log::LogContents;
use crate::rows::{Layout, Place};
use crate::segments::Segment;
use crate::selection::Selection;
use crate::statistics::Statistics;
use crate::table::Table;
use crate::{Channel, legacy};
use keep::{Keeping, Memory};
use spill::Spill;

/// Rows read at a time, and the largest number of rows in a block.
pub(crate) const BLOCK_ROWS: usize = 4096;

/// A recording over time, or the selected part of one.
///
/// Opening it reads the file once: every row has been checked, and segments and statistics are known. The samples
/// themselves are then given out by [`Dataset::blocks`] as often as wanted, or any part of them by [`Dataset::blocks_in`], also
/// to several threads at once. Recordings are kept in memory while all of them together are not too long, others
/// decoded in a temporary file while there is room for one, or read again from their own on each pass; the difference cannot be
/// seen from outside except in time.
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
    /// Rows a sample.
    parts: u32,
    lost_samples: u64,
    cut: Option<Cut>,
    contents: Option<Arc<LogContents>>,
    warnings: Vec<Warning>,
    source: Source,
}

#[derive(Debug, Clone)]
enum Source {
    Memory(Arc<Memory>),
    Spill(Arc<SpillSource>),
    File(Arc<FileSource>),
}

/// Columns in a temporary file.
#[derive(Debug)]
struct SpillSource {
    spill: Spill,
    /// The file's channel of each of the dataset's.
    columns: Vec<usize>,
}

/// How to read rows again.
#[derive(Debug)]
struct FileSource {
    path: PathBuf,
    layout: Layout,
    /// The file's channel of each of the dataset's.
    columns: Vec<usize>,
    /// Places to start from, every few thousand rows.
    marks: Vec<Mark>,
    /// Rows of the file before the dataset's first.
    skipped: u64,
}

/// Where a row of a file starts.
#[derive(Debug, Clone, Copy)]
struct Mark {
    row: u64,
    place: Place,
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
            format => Self::scan(selection, format, Keeping::with_columns),
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

    /// Rows for each sample as recorded: more than one where irregular samples were put on a finer grid
    /// ([`Dataset::on_regular_grid`]).
    #[must_use]
    pub fn rows_per_sample(&self) -> u32 {
        self.parts
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
        let all: Vec<usize> = (0..self.channels.len()).collect();
        self.blocks_in(0..self.rows, &all)
    }

    /// A pass over some rows and some channels (by index, in the order wanted). It starts where the rows are: what is before
    /// them is not read, and every pass has its own handle of the file.
    ///
    /// # Errors
    /// As [`Dataset::blocks`].
    ///
    /// # Panics
    /// When there is no such channel.
    pub fn blocks_in(&self, rows: Range<u64>, channels: &[usize]) -> Result<Blocks<'_>> {
        if let Some(channel) = channels.iter().find(|channel| **channel >= self.channels.len()) {
            panic!("channel {channel} of {}", self.channels.len());
        }
        Blocks::new(self, rows, channels.to_vec())
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
        for block in self.blocks_in(0..self.rows, &indices)? {
            let block = block?;
            time_s.extend_from_slice(&block.time_s);
            for (column, values) in columns.iter_mut().zip(&block.columns) {
                column.extend_from_slice(values.values());
            }
        }
        Ok(Loaded { time_s, columns: columns.into_iter().map(Column::new).collect() })
    }
}
