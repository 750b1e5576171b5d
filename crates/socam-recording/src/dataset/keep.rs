//! Where a recording's values stay for later passes: in memory, in a temporary file, or only where they came from.

use std::sync::atomic::{AtomicU64, Ordering};

use super::spill::{Spill, SpillWriter};
use crate::table::Table;

/// Values that all datasets together keep in memory (512 MiB, times included).
const VALUES: u64 = 64 << 20;

/// Values kept at the moment.
static KEPT: AtomicU64 = AtomicU64::new(0);

/// A table in memory and the room that it takes.
#[derive(Debug)]
pub(crate) struct Memory {
    pub(crate) table: Table,
    room: Room,
}

impl Memory {
    /// Columns that exist already, whatever room there is.
    pub(crate) fn existing(table: Table) -> Self {
        Self { table, room: Room::default() }
    }
}

/// A part of [`VALUES`], given back when it is dropped.
#[derive(Debug, Default)]
struct Room(u64);

impl Room {
    /// Takes so many values more; false when that would be too many.
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

/// Rows on their way to where they stay.
#[derive(Debug)]
pub(crate) enum Keeping {
    Memory(Memory),
    Spill(SpillWriter),
    Nothing,
}

/// Where they arrived.
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

    /// Takes more rows, of about `expected_rows` in all.
    pub(crate) fn append(&mut self, rows: &Table, expected_rows: u64) {
        if let Self::Memory(memory) = self {
            if memory.room.grow(rows.rows() as u64 * (1 + rows.columns.len() as u64)) {
                memory.table.append(rows);
                return;
            }
            self.leave_memory(expected_rows);
        }
        // A full disk is no reason to fail: the rows can be read from where they came.
        if let Self::Spill(spill) = self
            && spill.append(rows).is_err()
        {
            *self = Self::Nothing;
        }
    }

    /// Goes on in a temporary file, where there is room for one.
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
