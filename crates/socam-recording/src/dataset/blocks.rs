//! A pass over rows of a dataset, block by block.

use std::ops::Range;
use std::path::PathBuf;

use super::block::{Block, Column};
use super::source::{FileSource, Source, SpillSource};
use super::spill;
use crate::error::{RecordingError, Result};
use crate::rows::Again;
use crate::segments::Segment;
use crate::table::{BLOCK_ROWS, Table};

/// A pass over a dataset. See [`Dataset::blocks`](crate::Dataset::blocks) and [`Dataset::blocks_in`](crate::Dataset::blocks_in).
pub struct Blocks<'a> {
    name: &'a str,
    segments: &'a [Segment],
    columns: Vec<usize>,
    /// Rows not returned yet.
    rows: Range<u64>,
    segment: usize,
    feed: Feed<'a>,
}

enum Feed<'a> {
    Memory(&'a Table),
    Spill(&'a SpillSource, Vec<u8>),
    File(Reading),
    /// No more rows, by the end of the pass or after an error.
    Ended,
}

/// Rows read ahead from a file: `pending[given..]`.
struct Reading {
    again: Again,
    pending: Table,
    given: usize,
}

impl Reading {
    fn open(file: &FileSource, first_row: u64, columns: &[usize]) -> Result<Self> {
        let row = file.skipped + first_row;
        let mark = file.marks.partition_point(|mark| mark.row <= row).saturating_sub(1);
        let mark = file.marks[mark];
        let wanted: Vec<usize> = columns.iter().map(|column| file.columns[*column]).collect();
        let mut reading = Self {
            again: file.layout.open(&file.path, &wanted, mark.place)?,
            pending: Table::with_columns(columns.len()),
            given: 0,
        };
        reading.skip((row - mark.row) as usize)?;
        Ok(reading)
    }

    /// Reads until this many rows are pending; false where the file has fewer.
    fn have(&mut self, rows: usize) -> Result<bool> {
        if self.pending.rows() - self.given >= rows {
            return Ok(true);
        }
        self.pending.drop_first(self.given);
        self.given = 0;
        let mut more = true;
        while more && self.pending.rows() < rows {
            let missing = rows - self.pending.rows();
            more = self.again.read(&mut self.pending, missing)?;
        }
        Ok(self.pending.rows() >= rows)
    }

    fn skip(&mut self, rows: usize) -> Result<()> {
        let mut left = rows;
        while left > 0 && self.have(left.min(BLOCK_ROWS))? {
            let now = left.min(self.pending.rows() - self.given);
            self.given += now;
            left -= now;
        }
        Ok(())
    }
}

impl<'a> Blocks<'a> {
    pub(super) fn new(
        source: &'a Source,
        name: &'a str,
        segments: &'a [Segment],
        rows: Range<u64>,
        columns: Vec<usize>,
    ) -> Result<Self> {
        let rows = rows.start..rows.end.min(all_rows(segments));
        let feed = match source {
            _ if rows.is_empty() => Feed::Ended,
            Source::Memory(memory) => Feed::Memory(&memory.table),
            Source::Spill(source) => Feed::Spill(source, Vec::new()),
            Source::File(file) => Feed::File(Reading::open(file, rows.start, &columns)?),
        };
        let segment = segments.partition_point(|segment| segment.end_row() <= rows.start);
        Ok(Self { name, segments, columns, rows, segment, feed })
    }

    /// The next block. Blocks have the same limits for every source.
    fn next_block(&mut self) -> Result<Option<Block>> {
        let first_row = self.rows.start;
        let Some(segment) = self.segments.get(self.segment).filter(|_| !self.rows.is_empty()) else {
            return Ok(None);
        };
        let end_row = self.rows.end.min(segment.end_row()).min(first_row + BLOCK_ROWS as u64);
        let rows = (end_row - first_row) as usize;
        let cut = |column: &[f64]| Column::new(column.to_vec());
        let (time_s, columns) = match &mut self.feed {
            Feed::Ended => return Ok(None),
            Feed::Memory(table) => {
                let range = first_row as usize..end_row as usize;
                let columns = self.columns.iter().map(|column| cut(&table.columns[*column][range.clone()]));
                (table.time_s[range.clone()].to_vec(), columns.collect())
            }
            Feed::Spill(source, bytes) => {
                let mut read = |column: usize| {
                    let values = source.spill.read(column, first_row..end_row, bytes);
                    values.map_err(|e| RecordingError::io(&spill::folder(), "read a temporary file in", e))
                };
                let columns = self.columns.iter().map(|c| Ok(Column::new(read(1 + source.columns[*c])?)));
                let columns = columns.collect::<Result<Vec<_>>>()?;
                (read(0)?, columns)
            }
            Feed::File(reading) => {
                if !reading.have(rows)? {
                    return Err(RecordingError::Changed {
                        path: PathBuf::from(self.name),
                        expected_rows: all_rows(self.segments),
                        found_rows: first_row + (reading.pending.rows() - reading.given) as u64,
                    });
                }
                let range = reading.given..reading.given + rows;
                reading.given += rows;
                let columns = reading.pending.columns.iter().map(|column| cut(&column[range.clone()]));
                (reading.pending.time_s[range.clone()].to_vec(), columns.collect())
            }
        };
        let block = Block { segment: self.segment, first_row, time_s, columns };
        self.rows.start = end_row;
        if end_row == segment.end_row() {
            self.segment += 1;
        }
        Ok(Some(block))
    }
}

fn all_rows(segments: &[Segment]) -> u64 {
    segments.last().map_or(0, Segment::end_row)
}

impl Iterator for Blocks<'_> {
    type Item = Result<Block>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.next_block().transpose();
        if let Some(Err(_)) = next {
            self.feed = Feed::Ended;
        }
        next
    }
}
