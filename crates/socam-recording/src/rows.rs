//! Rows streaming from a file of one format or another: all of them once, then any part of them again.

use std::path::{Path, PathBuf};

use crate::Channel;
use crate::csv_read::{CsvLayout, CsvRows};
use crate::dataset::{Cut, Warning};
use crate::error::{RecordingError, Result};
use crate::format::Format;
use crate::log::LogContents;
use crate::log::decode::LogLayout;
use crate::log::read::{LogSamples, LogScan};
use crate::table::Table;

/// A place in a file at which reading can start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) byte: u64,
    /// Line number, where the file has lines.
    pub(crate) line: u64,
}

/// Some rows of a file and where they start and end.
#[derive(Debug)]
pub(crate) struct Part {
    pub(crate) place: Place,
    pub(crate) end_byte: u64,
    pub(crate) table: Table,
}

/// The first reading of a file: checks every row and finds out what else there is.
pub(crate) enum Scan {
    Csv(Box<CsvRows>),
    Log(Box<LogScan>),
}

/// What is known once the last row has been seen.
#[derive(Debug)]
pub(crate) struct EndOfRows {
    /// How to read rows again.
    pub(crate) layout: Layout,
    /// Columns that turned out to hold no numbers.
    pub(crate) unusable: Vec<usize>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) lost_samples: u64,
    pub(crate) cut: Option<Cut>,
    pub(crate) contents: Option<LogContents>,
}

impl Scan {
    pub(crate) fn open(path: &Path, format: Format) -> Result<Self> {
        match format {
            Format::Csv => Ok(Self::Csv(Box::new(CsvRows::open(path)?))),
            Format::Mcap => Ok(Self::Log(Box::new(LogScan::open(path)?))),
            _ => Err(RecordingError::Foreign {
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

    /// The next rows, none empty; nothing once there are no more.
    pub(crate) fn next(&mut self) -> Result<Vec<Part>> {
        match self {
            Self::Csv(rows) => rows.next(),
            Self::Log(rows) => rows.next(),
        }
    }

    pub(crate) fn finish(self) -> EndOfRows {
        match self {
            Self::Csv(rows) => rows.finish(),
            Self::Log(rows) => rows.finish(),
        }
    }
}

/// What a scan found out about a file's rows, so that they can be read again from any place.
#[derive(Debug, Clone)]
pub(crate) enum Layout {
    Csv(CsvLayout),
    Log(LogLayout),
}

/// A second reading, of some columns, from some place on.
pub(crate) enum Again {
    Csv(Box<CsvRows>),
    Log(Box<LogSamples>),
}

impl Layout {
    /// `columns`: which of the file's channels to read, in the order wanted.
    pub(crate) fn open(&self, path: &Path, columns: &[usize], place: Place) -> Result<Again> {
        match self {
            Self::Csv(layout) => Ok(Again::Csv(Box::new(CsvRows::resume(path, layout, columns, place)?))),
            Self::Log(layout) => Ok(Again::Log(Box::new(LogSamples::resume(path, layout, columns, place)?))),
        }
    }
}

impl Again {
    /// Appends about `rows` rows; false once there are no more.
    pub(crate) fn read(&mut self, table: &mut Table, rows: usize) -> Result<bool> {
        match self {
            Self::Csv(lines) => lines.read(table, rows),
            Self::Log(log) => log.read(table, rows),
        }
    }
}
