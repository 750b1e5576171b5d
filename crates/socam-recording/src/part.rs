//! Common output of the readers of all file formats: tables with their places, then facts that are known only at the end.

use crate::log::contents::LogContents;
use crate::table::Table;
use crate::warning::{Cut, Warning};

/// A place in a file at which reading can start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) byte: u64,
    /// Line number, where the file has lines.
    pub(crate) line: u64,
}

/// Some rows of a file, with their first and last byte.
#[derive(Debug)]
pub(crate) struct Part {
    pub(crate) place: Place,
    pub(crate) end_byte: u64,
    pub(crate) table: Table,
}

/// Facts that a reader knows after the last row.
#[derive(Debug)]
pub(crate) struct EndOfRows {
    /// Indices of columns without numbers.
    pub(crate) unusable: Vec<usize>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) lost_samples: u64,
    pub(crate) cut: Option<Cut>,
    pub(crate) contents: Option<LogContents>,
}
