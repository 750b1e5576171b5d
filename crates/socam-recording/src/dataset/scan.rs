//! The first reading of a file: checks every row and finds segments, statistics and places at which reading can start.

use std::sync::Arc;

use super::data::Dataset;
use super::keep::{Keeping, Kept};
use super::source::{FileSource, Mark, Source, SpillSource};
use super::tally::Tally;
use crate::Channel;
use crate::clock_time::Epoch;
use crate::error::{RecordingError, Result};
use crate::format::Format;
use crate::log::contents::LogContents;
use crate::part::{EndOfRows, Part};
use crate::rows::{Layout, Scan};
use crate::selection::{Selection, Span};
use crate::table::BLOCK_ROWS;
use crate::warning;

impl Dataset {
    /// Reads the file once, and keeps the values while there is room.
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
            // The next parts are read while these are appended.
            let (next, ()) =
                rayon::join(|| scan.next(), || parts.into_iter().for_each(|part| first.append(part)));
            parts = next?;
        }
        if first.tally.rows == 0 {
            return Err(match scan.finish().1 {
                end if first.row == 0 => without_samples(selection, &end),
                _ => RecordingError::NoSamples { path: selection.path.clone(), is_whole: false },
            });
        }
        Self::assemble(first, format, &all_channels, scan.finish())
    }

    fn assemble(
        first: FirstPass<'_>,
        format: Format,
        all_channels: &[Channel],
        (layout, end): (Layout, EndOfRows),
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
                layout,
                columns,
                marks: first.marks,
                skipped: first.skipped,
            })),
        };
        let start_s = segments.first().map_or(0.0, |segment| segment.start_s);
        let stated = end.contents.as_ref().and_then(LogContents::epoch);
        let epoch = Epoch::of_times(start_s).or(stated);
        Ok(Self {
            name: selection.name(),
            format,
            channels,
            statistics,
            segments,
            sample_time_s,
            rows: tally.rows,
            parts: 1,
            uneven: false,
            lost_samples: end.lost_samples,
            cut: end.cut,
            epoch,
            contents: end.contents.map(Arc::new),
            warnings: end.warnings,
            source,
        })
    }
}

/// Why a file that was read to its end has no samples.
fn without_samples(selection: &Selection, end: &EndOfRows) -> RecordingError {
    let path = selection.path.clone();
    match (warning::damage(&end.warnings), &end.cut) {
        (Some(damage), _) => RecordingError::AllDamaged { path, damage },
        (None, Some(cut)) => {
            let problem = "the log is cut off here, before its first samples; copy it again from its source, or record again";
            RecordingError::Byte { path, byte: cut.byte, problem: problem.into() }
        }
        (None, None) => RecordingError::NoSamples { path, is_whole: selection.span == Span::ALL },
    }
}

/// The state of a first pass over a file.
struct FirstPass<'a> {
    selection: &'a Selection,
    file_bytes: u64,
    tally: Tally,
    kept: Keeping,
    marks: Vec<Mark>,
    /// Rows of the file so far.
    row: u64,
    /// Rows of the file before the selected span.
    skipped: u64,
}

impl FirstPass<'_> {
    fn append(&mut self, part: Part) {
        let Part { place, end_byte, mut table } = part;
        if self.marks.last().is_none_or(|mark| self.row - mark.row >= BLOCK_ROWS as u64) {
            self.marks.push(Mark { row: self.row, place });
        }
        self.row += table.rows() as u64;
        let expected_rows = self.row as f64 / end_byte as f64 * self.file_bytes as f64;
        self.skipped += table.retain_span(self.selection.span) as u64;
        self.tally.append(&table);
        self.kept.append(&table, expected_rows as u64);
    }
}
