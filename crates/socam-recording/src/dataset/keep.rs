//! Keeps a recording's values for later passes: in memory, in a temporary file, or not at all.

use std::sync::atomic::{AtomicU64, Ordering};

use super::spill::{Spill, SpillWriter};
use crate::table::Table;

/// Values that all datasets together keep in memory (512 MiB, times included).
const VALUES: u64 = 64 << 20;

/// Number of values kept now.
static KEPT: AtomicU64 = AtomicU64::new(0);

/// A table in memory and its share of the limit.
#[derive(Debug)]
pub(crate) struct Memory {
    pub(crate) table: Table,
    room: Room,
}

impl Memory {
    /// Columns that exist already; they do not count towards the limit.
    pub(crate) fn existing(table: Table) -> Self {
        Self { table, room: Room::default() }
    }
}

/// A share of [`VALUES`], released on drop.
#[derive(Debug, Default)]
struct Room(u64);

impl Room {
    /// Reserves this many more values; false when the limit would be exceeded.
    fn grow(&mut self, values: u64) -> bool {
        let fits = |kept: u64| kept.checked_add(values).filter(|kept| *kept <= VALUES);
        let grown = KEPT.fetch_update(Ordering::Relaxed, Ordering::Relaxed, fits).is_ok();
        self.0 += if grown { values } else { 0 };
        grown
    }
}

impl Drop for Room {
    fn drop(&mut self) {
        KEPT.fetch_sub(self.0, Ordering::Relaxed);
    }
}

/// Rows being kept.
#[derive(Debug)]
pub(crate) enum Keeping {
    Memory(Memory),
    Spill(SpillWriter),
    Nothing,
}

/// All rows, kept.
#[derive(Debug)]
pub(crate) enum Kept {
    Memory(Memory),
    Spill(Spill),
    Nothing,
}

impl Keeping {
    pub(crate) fn with_columns(columns: usize) -> Self {
        Self::Memory(Memory::existing(Table::with_columns(columns)))
    }

    /// Appends rows, of about `expected_rows` in all.
    pub(crate) fn append(&mut self, rows: &Table, expected_rows: u64) {
        if let Self::Memory(memory) = self {
            if memory.room.grow(rows.rows() as u64 * (1 + rows.columns.len() as u64)) {
                memory.table.append(rows);
                return;
            }
            self.leave_memory(expected_rows);
        }
        // A full disk is no error: the rows can be read from the recording's own file.
        if let Self::Spill(spill) = self
            && spill.append(rows).is_err()
        {
            *self = Self::Nothing;
        }
    }

    /// Moves the rows to a temporary file, where there is room for one.
    pub(crate) fn leave_memory(&mut self, expected_rows: u64) {
        if let Self::Memory(memory) = self {
            let spill = SpillWriter::create(memory.table.columns.len(), expected_rows);
            let moved = |mut spill: SpillWriter| spill.append(&memory.table).is_ok().then_some(spill);
            *self = spill.and_then(moved).map_or(Self::Nothing, Self::Spill);
        }
    }

    pub(crate) fn finish(self) -> Kept {
        match self {
            Self::Memory(memory) => Kept::Memory(memory),
            Self::Spill(spill) => spill.finish().map_or(Kept::Nothing, Kept::Spill),
            Self::Nothing => Kept::Nothing,
        }
    }
}
