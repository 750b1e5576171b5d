//! The first reading of a recording: every row is checked, segments, statistics and places to start from are found.

use std::path::PathBuf;
use std::sync::Arc;

use super::memory::{Keeping, Memory};
use super::{BLOCK_ROWS, Dataset, FileSource, Mark, Source};
use crate::Channel;
use crate::error::{RecordingError, Result};
use crate::format::Format;
use crate::rows::{EndOfRows, Scan};
use crate::segments::SegmentFinder;
use crate::selection::Selection;
use crate::statistics::Running;
use crate::table::Table;

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
            running.take(column);
        }
        self.rows += table.rows() as u64;
    }
}

impl Dataset {
    /// A dataset of a table in memory; of a part of it where less is selected.
    pub(super) fn from_table(
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
            rows: table.rows() as u64,
            lost_samples: 0,
            cut: None,
            contents: None,
            warnings: Vec::new(),
            source: Source::Memory(Arc::new(Memory::existing(table))),
        })
    }

    /// Reads the file once, and keeps the values while there is room for them.
    pub(super) fn scan(
        selection: &Selection,
        format: Format,
        keeping: impl FnOnce(usize) -> Keeping,
    ) -> Result<Self> {
        let mut scan = Scan::open(&selection.path, format)?;
        let all_channels = scan.channels().to_vec();
        let mut tally = Tally::new(all_channels.len());
        let mut kept = keeping(all_channels.len());
        let mut read = Table::with_columns(all_channels.len());
        let mut marks: Vec<Mark> = Vec::new();
        let (mut row, mut skipped) = (0, 0);
        let mut more = true;
        while more {
            if marks.last().is_none_or(|mark| row - mark.row >= BLOCK_ROWS as u64) {
                marks.push(Mark { row, place: scan.place() });
            }
            read.clear();
            more = scan.read(&mut read, BLOCK_ROWS)?;
            row += read.rows() as u64;
            skipped += read.retain_span(selection.span) as u64;
            tally.take(&read);
            kept.append(&read);
        }
        if tally.rows == 0 {
            return Err(RecordingError::NoSamples { path: selection.path.clone() });
        }
        let file = FileRows { path: selection.path.clone(), marks, skipped };
        Self::assemble(selection, format, &all_channels, tally, kept.finish(), file, scan.finish())
    }

    fn assemble(
        selection: &Selection,
        format: Format,
        all_channels: &[Channel],
        tally: Tally,
        kept: Option<Memory>,
        file: FileRows,
        end: EndOfRows,
    ) -> Result<Self> {
        let columns: Vec<usize> =
            (0..all_channels.len()).filter(|column| !end.unusable.contains(column)).collect();
        if columns.is_empty() {
            return Err(RecordingError::NoChannels { path: selection.path.clone() });
        }
        let (segments, sample_time_s) = tally.finder.finish();
        let channels = columns.iter().map(|&c| all_channels[c].clone()).collect();
        let statistics = columns.iter().map(|&c| tally.running[c].finish()).collect();
        let source = match kept {
            Some(mut memory) => {
                let all = &mut memory.table.columns;
                *all = columns.iter().map(|&column| std::mem::take(&mut all[column])).collect();
                Source::Memory(Arc::new(memory))
            }
            None => Source::File(Arc::new(FileSource {
                path: file.path,
                layout: end.layout,
                columns,
                marks: file.marks,
                skipped: file.skipped,
            })),
        };
        Ok(Self {
            name: selection.name(),
            format,
            channels,
            statistics,
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
}

/// Where a file's rows are.
struct FileRows {
    path: PathBuf,
    marks: Vec<Mark>,
    skipped: u64,
}
