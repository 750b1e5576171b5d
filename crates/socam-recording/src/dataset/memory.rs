//! Values kept in memory, within a limit for all recordings together.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::table::Table;

/// Values that all datasets together keep (512 MiB, times included); what is beyond is read again on every pass.
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

/// A table that grows while there is room for it.
#[derive(Debug)]
pub(crate) struct Keeping(Option<Memory>);

impl Keeping {
    pub(crate) fn with_columns(columns: usize) -> Self {
        Self(Some(Memory::existing(Table::with_columns(columns))))
    }

    /// Never keeps anything.
    #[cfg(test)]
    pub(crate) fn nothing() -> Self {
        Self(None)
    }

    pub(crate) fn append(&mut self, rows: &Table) {
        let values = rows.rows() as u64 * (1 + rows.columns.len() as u64);
        if let Some(kept) = &mut self.0 {
            if kept.room.grow(values) {
                kept.table.append(rows);
            } else {
                self.0 = None;
            }
        }
    }

    /// Whatever was kept, if it is everything.
    pub(crate) fn finish(self) -> Option<Memory> {
        self.0
    }
}
