//! Location of the samples of a dataset: in memory, in a temporary file, or only in the recording's own file.

use std::path::PathBuf;
use std::sync::Arc;

use super::keep::Memory;
use super::spill::Spill;
use crate::part::Place;
use crate::rows::Layout;

/// Location of a dataset's samples.
#[derive(Debug, Clone)]
pub(super) enum Source {
    Memory(Arc<Memory>),
    Spill(Arc<SpillSource>),
    File(Arc<FileSource>),
}

/// Columns in a temporary file.
#[derive(Debug)]
pub(super) struct SpillSource {
    pub(super) spill: Spill,
    /// Index in the file of each of the dataset's channels.
    pub(super) columns: Vec<usize>,
}

/// The recording's own file, and how its rows are read again.
#[derive(Debug)]
pub(super) struct FileSource {
    pub(super) path: PathBuf,
    pub(super) layout: Layout,
    /// Index in the file of each of the dataset's channels.
    pub(super) columns: Vec<usize>,
    /// Places at which reading can start, every few thousand rows.
    pub(super) marks: Vec<Mark>,
    /// Number of rows in the file before the dataset's first.
    pub(super) skipped: u64,
}

/// The place at which a row of a file starts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    pub(super) row: u64,
    pub(super) place: Place,
}
