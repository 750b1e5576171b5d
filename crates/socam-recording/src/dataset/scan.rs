//! The first reading of a recording: every row is checked, segments, statistics and places to start from are found.

use std::sync::Arc;

use super::keep::{Keeping, Kept, Memory};
use super::{BLOCK_ROWS, Dataset, FileSource, Mark, Source, SpillSource};
use crate::Channel;
use crate::error::{RecordingError, Result};
use crate::format::Format;
use crate::rows::{EndOfRows, Part, Scan};
use crate::segments::SegmentFinder;
use crate::selection::Selection;
use crate::statistics::Running;
use crate::table::Table;

/// What a first pass gathers.
pub(super) struct Tally {
    pub(super) finder: SegmentFinder,
    pub(super) running: Vec<Running>,
    pub(super) rows: u64,
}

impl Tally {
    pub(super) fn new(columns: usize) -> Self {
        Self { finder: SegmentFinder::new(), running: vec![Running::new(); columns], rows: 0 }
    }

    pub(super) fn take(&mut self, table: &Table) {
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
            parts: 1,
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
        let mut first = FirstPass {
            selection,
            file_bytes: crate::files::open(&selection.path).map_or(0, |(_, length)| length),
            tally: Tally::new(all_channels.len()),
            kept: keeping(all_channels.len()),
            marks: Vec::new(),
            row: 0,
            skipped: 0,
        };
        let mut parts = scan.next()?;
        while !parts.is_empty() {
            // While these are taken in the next are read.
            let (next, ()) =
                rayon::join(|| scan.next(), || parts.into_iter().for_each(|part| first.take(part)));
            parts = next?;
        }
        if first.tally.rows == 0 {
            return Err(RecordingError::NoSamples { path: selection.path.clone() });
        }
        Self::assemble(first, format, &all_channels, scan.finish())
    }

    fn assemble(
        first: FirstPass<'_>,
        format: Format,
        all_channels: &[Channel],
        end: EndOfRows,
    ) -> Result<Self> {
        let FirstPass { selection, tally, .. } = first;
        let columns: Vec<usize> =
            (0..all_channels.len()).filter(|column| !end.unusable.contains(column)).collect();
        if columns.is_empty() {
            return Err(RecordingError::NoChannels { path: selection.path.clone() });
        }
        let (segments, sample_time_s) = tally.finder.finish();
        let channels = columns.iter().map(|&c| all_channels[c].clone()).collect();
        let statistics = columns.iter().map(|&c| tally.running[c].finish()).collect();
        let source = match first.kept.finish() {
            Kept::Memory(mut memory) => {
                let all = &mut memory.table.columns;
                *all = columns.iter().map(|&column| std::mem::take(&mut all[column])).collect();
                Source::Memory(Arc::new(memory))
            }
            Kept::Spill(spill) => Source::Spill(Arc::new(SpillSource { spill, columns })),
            Kept::Nothing => Source::File(Arc::new(FileSource {
                path: selection.path.clone(),
                layout: end.layout,
                columns,
                marks: first.marks,
                skipped: first.skipped,
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
            parts: 1,
            lost_samples: end.lost_samples,
            cut: end.cut,
            contents: end.contents.map(Arc::new),
            warnings: end.warnings,
            source,
        })
    }
}

/// What a first pass over a file has come to.
struct FirstPass<'a> {
    selection: &'a Selection,
    file_bytes: u64,
    tally: Tally,
    kept: Keeping,
    marks: Vec<Mark>,
    /// Rows of the file so far.
    row: u64,
    /// Of these, before the span selected.
    skipped: u64,
}

impl FirstPass<'_> {
    fn take(&mut self, part: Part) {
        let Part { place, end_byte, mut table } = part;
        if self.marks.last().is_none_or(|mark| self.row - mark.row >= BLOCK_ROWS as u64) {
            self.marks.push(Mark { row: self.row, place });
        }
        self.row += table.rows() as u64;
        let expected_rows = self.row as f64 / end_byte as f64 * self.file_bytes as f64;
        self.skipped += table.retain_span(self.selection.span) as u64;
        self.tally.take(&table);
        self.kept.append(&table, expected_rows as u64);
    }
}
