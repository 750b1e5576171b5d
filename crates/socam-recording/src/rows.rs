//! The first reading of a file, and further readings of any part of it, whatever its format.

use std::path::{Path, PathBuf};

use crate::Channel;
use crate::csv_read::{CsvLayout, CsvRows};
use crate::error::{RecordingError, Result};
use crate::format::Format;
use crate::log::decode::LogLayout;
use crate::log::reread::LogSamples;
use crate::log::scan::LogScan;
use crate::part::{EndOfRows, Part, Place};
use crate::table::Table;

/// The first reading of a file: checks every row and collects all other contents.
pub(crate) enum Scan {
    Csv(Box<CsvRows>),
    Log(Box<LogScan>),
}

impl Scan {
    pub(crate) fn open(path: &Path, format: Format) -> Result<Self> {
        match format {
            Format::Csv => Ok(Self::Csv(Box::new(CsvRows::open(path)?))),
            Format::Mcap => Ok(Self::Log(Box::new(LogScan::open(path)?))),
            Format::LegacyM | Format::SteadyStates | Format::Memory => Err(RecordingError::Foreign {
                path: PathBuf::from(path),
                found: format!("is {format}, which this version does not read"),
            }),
        }
    }

    pub(crate) fn channels(&self) -> &[Channel] {
        match self {
            Self::Csv(rows) => rows.channels(),
            Self::Log(rows) => rows.channels(),
        }
    }

    /// The next rows, in tables that are not empty; no table after the last row.
    pub(crate) fn next(&mut self) -> Result<Vec<Part>> {
        match self {
            Self::Csv(rows) => rows.next(),
            Self::Log(rows) => rows.next(),
        }
    }

    /// The layout, from which rows can be read again, and what else is known at the end.
    pub(crate) fn finish(self) -> (Layout, EndOfRows) {
        match self {
            Self::Csv(rows) => {
                let (layout, end) = rows.finish();
                (Layout::Csv(layout), end)
            }
            Self::Log(rows) => {
                let (layout, end) = rows.finish();
                (Layout::Log(layout), end)
            }
        }
    }
}

/// Positions of a file's channels in its rows, as a scan found them, from which rows are read again at any place.
#[derive(Debug, Clone)]
pub(crate) enum Layout {
    Csv(CsvLayout),
    Log(LogLayout),
}

/// A further reading of some columns, from some place on.
pub(crate) enum Again {
    Csv(Box<CsvRows>),
    Log(Box<LogSamples>),
}

impl Layout {
    /// Opens a further reading. `columns`: indices of the file's channels, in the order of the table's columns.
    pub(crate) fn open(&self, path: &Path, columns: &[usize], place: Place) -> Result<Again> {
        match self {
            Self::Csv(layout) => Ok(Again::Csv(Box::new(CsvRows::resume(path, layout, columns, place)?))),
            Self::Log(layout) => Ok(Again::Log(Box::new(LogSamples::resume(path, layout, columns, place)?))),
        }
    }
}

impl Again {
    /// Appends about `rows` rows; false after the last row.
    pub(crate) fn read(&mut self, table: &mut Table, rows: usize) -> Result<bool> {
        match self {
            Self::Csv(lines) => lines.read(table, rows),
            Self::Log(log) => log.read(table, rows),
        }
    }
}
