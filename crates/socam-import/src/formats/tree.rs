//! Arrays of a tree of variables (MATLAB, HDF5), as groups of signals of equal length.

use socam_recording::Warning;

use crate::source::{Group, Signal, Source, Wanted};

/// Most columns of a matrix that are taken as signals.
const MOST_COLUMNS: usize = 256;
/// Most rows of a matrix that are taken as signals.
const MOST_ROWS: usize = 32;
/// Shortest array that can be a signal.
const SHORTEST: usize = 8;

/// Collects arrays.
pub(super) struct Arrays<'w> {
    wanted: &'w Wanted,
    /// Length and signals of each group.
    groups: Vec<(usize, Vec<Signal>)>,
    notes: Vec<Warning>,
    /// Names and values of numbers that stand alone: a sample time may be among them.
    scalars: Vec<(String, f64)>,
}

impl<'w> Arrays<'w> {
    pub(super) fn new(wanted: &'w Wanted) -> Self {
        Self { wanted, groups: Vec::new(), notes: Vec::new(), scalars: Vec::new() }
    }

    /// Whether an array should be read.
    pub(super) fn takes(&self, path: &str, columns: usize) -> bool {
        (0..columns.min(MOST_COLUMNS))
            .any(|column| self.wanted.takes("", &column_name(path, columns, column)))
    }

    /// Whether nothing was added yet.
    pub(super) fn is_empty(&self) -> bool {
        self.groups.is_empty() && self.scalars.is_empty()
    }

    pub(super) fn incomplete(&mut self, what: String) {
        self.notes.push(Warning::Incomplete { what });
    }

    pub(super) fn leave(&mut self, path: &str, why: &str) {
        self.notes.push(Warning::Note(format!("`{path}` {why} and is left aside")));
    }

    pub(super) fn scalar(&mut self, path: &str, value: f64) {
        self.scalars.push((path.to_owned(), value));
    }

    /// Whether the signals of a matrix are its rows, as in files that Simulink writes.
    pub(super) fn is_by_rows(rows: usize, columns: usize) -> bool {
        rows > 1 && rows <= MOST_ROWS && columns >= SHORTEST.max(4 * rows)
    }

    /// Adds a matrix whose columns stand one behind the other. Its signals are its columns, or its rows where those are few and long.
    pub(super) fn add_matrix(
        &mut self,
        path: &str,
        unit: Option<&str>,
        rows: usize,
        columns: usize,
        values: &[f64],
    ) {
        if !Self::is_by_rows(rows, columns) {
            return self.add(path, unit, columns, values);
        }
        let turned: Vec<f64> =
            (0..rows).flat_map(|row| values.iter().skip(row).step_by(rows)).copied().collect();
        self.add(path, unit, rows, &turned);
    }

    /// Adds signals that stand one behind the other.
    pub(super) fn add(&mut self, path: &str, unit: Option<&str>, columns: usize, values: &[f64]) {
        if columns == 0 || columns > MOST_COLUMNS {
            return self.leave(path, &format!("has {columns} columns"));
        }
        let rows = values.len() / columns;
        if rows == 1 && columns == 1 {
            return self.scalar(path, values[0]);
        }
        if rows < SHORTEST {
            return self.leave(path, &format!("has {rows} rows"));
        }
        for (column, values) in values.chunks_exact(rows).enumerate() {
            let name = column_name(path, columns, column);
            if !self.wanted.takes("", &name) {
                continue;
            }
            let kept = values[..rows.min(self.wanted.most_rows)].to_vec();
            let signal = Signal::new(name, unit.map(str::to_owned), kept);
            match self.groups.iter_mut().find(|(length, _)| *length == rows) {
                Some((_, signals)) => signals.push(signal),
                None => self.groups.push((rows, vec![signal])),
            }
        }
    }

    /// Arrays of equal length share a clock.
    pub(super) fn finish(mut self) -> Source {
        for (name, value) in &self.scalars {
            let small = name.to_ascii_lowercase();
            let last = small.rsplit(['.', '/']).next().unwrap_or(&small);
            if matches!(
                last,
                "fs" | "ts" | "dt" | "rate" | "samplerate" | "sample_rate" | "sampletime" | "sample_time"
            ) {
                self.notes
                    .push(Warning::Note(format!("`{name}` is {value}: a sample rate or a sample time?")));
            }
        }
        let is_single = self.groups.len() == 1;
        let group = |(length, signals): (usize, Vec<Signal>)| Group {
            name: if is_single { String::new() } else { format!("{length} rows") },
            signals,
            ..Group::default()
        };
        Source {
            groups: self.groups.into_iter().map(group).collect(),
            notes: self.notes,
            ..Source::default()
        }
        .tidy()
    }
}

fn column_name(path: &str, columns: usize, column: usize) -> String {
    if columns == 1 { path.to_owned() } else { format!("{path}.{}", column + 1) }
}
