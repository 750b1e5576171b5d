//! A table of rows in memory, stored by column: readers fill it, and blocks are copied from it.

use std::ops::Range;

use crate::selection::Span;

/// Rows read at a time, and the largest number of rows in a block.
pub(crate) const BLOCK_ROWS: usize = 4096;

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

    pub(crate) fn rows(&self) -> usize {
        self.time_s.len()
    }

    pub(crate) fn clear(&mut self) {
        self.all().for_each(Vec::clear);
    }

    pub(crate) fn append(&mut self, other: &Self) {
        self.append_part(other, 0..other.rows());
    }

    pub(crate) fn append_part(&mut self, other: &Self, rows: Range<usize>) {
        self.time_s.extend_from_slice(&other.time_s[rows.clone()]);
        for (mine, theirs) in self.columns.iter_mut().zip(&other.columns) {
            mine.extend_from_slice(&theirs[rows.clone()]);
        }
    }

    pub(crate) fn drop_first(&mut self, rows: usize) {
        self.all().for_each(|column| drop(column.drain(..rows)));
    }

    /// Removes rows outside the span; returns the number removed before it.
    pub(crate) fn retain_span(&mut self, span: Span) -> usize {
        if span == Span::ALL {
            return 0;
        }
        let start = self.time_s.partition_point(|t| *t < span.from_s);
        let end = self.time_s.partition_point(|t| *t < span.to_s).max(start);
        self.all().for_each(|column| column.truncate(end));
        self.drop_first(start);
        start
    }

    /// The times, then each column.
    pub(crate) fn all(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        std::iter::once(&mut self.time_s).chain(&mut self.columns)
    }
}
