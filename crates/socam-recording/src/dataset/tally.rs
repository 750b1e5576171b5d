//! Segments and statistics, in one pass over a recording's rows.

use crate::segments::SegmentFinder;
use crate::statistics::Running;
use crate::table::Table;

/// Segments, statistics and number of the rows so far.
pub(super) struct Tally {
    pub(super) finder: SegmentFinder,
    pub(super) running: Vec<Running>,
    pub(super) rows: u64,
}

impl Tally {
    pub(super) fn new(columns: usize) -> Self {
        Self { finder: SegmentFinder::new(), running: vec![Running::new(); columns], rows: 0 }
    }

    pub(super) fn append(&mut self, table: &Table) {
        table.time_s.iter().for_each(|t| self.finder.push(*t));
        for (running, column) in self.running.iter_mut().zip(&table.columns) {
            running.take(column);
        }
        self.rows += table.rows() as u64;
    }
}
