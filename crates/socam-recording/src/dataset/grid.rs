//! Interpolates irregular samples at the points of a regular grid.

use std::collections::VecDeque;

use super::keep::Keeping;
use super::tally::Tally;
use crate::table::{BLOCK_ROWS, Table};

/// Samples on either side that a value is interpolated from.
const SIDE: usize = 3;

/// Largest sum of the weights' magnitudes; above it a polynomial enlarges noise, and one of lower degree is used.
const MOST_WEIGHT: f64 = 2.0;

/// Method by which a channel is resampled to a regular grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carry {
    /// Zero-order hold: its mean from a point of the grid to the next.
    Hold,
    /// Linear interpolation.
    Linear,
    /// The polynomial of fifth degree through the six nearest samples.
    Smooth,
    /// The polynomial of fifth degree through the six nearest samples, evaluated only at the grid point nearest to each sample;
    /// other points have no value.
    Sampled,
}

/// The grid's rows: kept, with their segments and statistics.
pub(super) struct Resampled {
    pub(super) tally: Tally,
    pub(super) kept: Keeping,
    /// Rows not appended yet.
    table: Table,
    expected_rows: u64,
}

impl Resampled {
    pub(super) fn new(columns: usize, expected_rows: u64) -> Self {
        Self {
            tally: Tally::new(columns),
            kept: Keeping::with_columns(columns),
            table: Table::with_columns(columns),
            expected_rows,
        }
    }

    /// Appends a row.
    pub(super) fn push(&mut self, time_s: f64, values: impl Iterator<Item = f64>) {
        self.table.time_s.push(time_s);
        self.table.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        if self.table.rows() >= BLOCK_ROWS {
            self.flush();
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.tally.rows == 0 && self.table.rows() == 0
    }

    pub(super) fn flush(&mut self) {
        self.tally.append(&self.table);
        self.kept.append(&self.table, self.expected_rows);
        self.table.clear();
    }
}

/// Resamples one segment without a gap. It holds the samples that the next points of the grid need.
pub(super) struct Resampler {
    raw: VecDeque<(f64, Vec<f64>)>,
    start_s: f64,
    step_s: f64,
    /// Number of points of the grid that are done.
    done: u64,
}

impl Resampler {
    pub(super) fn new(start_s: f64, step_s: f64) -> Self {
        Self { raw: VecDeque::new(), start_s, step_s, done: 0 }
    }

    /// Time of the last sample, s.
    pub(super) fn last_s(&self) -> f64 {
        self.raw.back().map_or(self.start_s, |(time_s, _)| *time_s)
    }

    fn next_s(&self) -> f64 {
        self.start_s + self.done as f64 * self.step_s
    }

    /// Appends a sample, and computes the points that have enough samples after them.
    pub(super) fn push(&mut self, sample: (f64, Vec<f64>), carries: &[Carry], out: &mut Resampled) {
        self.raw.push_back(sample);
        let Some(known) = self.raw.len().checked_sub(SIDE + 2) else { return };
        while self.next_s() <= self.raw[known].0 {
            self.point(carries, out);
        }
        // Keeps SIDE samples before the next point, and one more that may lie nearest to it.
        let next_s = self.next_s();
        while self.raw.len() > SIDE + 2 && self.raw[SIDE + 1].0 < next_s {
            self.raw.pop_front();
        }
    }

    /// Computes the points up to the last sample.
    pub(super) fn finish(mut self, carries: &[Carry], out: &mut Resampled) {
        while self.next_s() <= self.last_s() {
            self.point(carries, out);
        }
    }

    fn point(&mut self, carries: &[Carry], out: &mut Resampled) {
        let time_s = self.next_s();
        self.done += 1;
        let after = self.raw.partition_point(|(t, _)| *t <= time_s + 1e-9 * self.step_s);
        let before = after.saturating_sub(1);
        let near = if after < self.raw.len() && self.raw[after].0 - time_s < time_s - self.raw[before].0 {
            after
        } else {
            before
        };
        let is_near = (self.raw[near].0 - time_s).abs() <= 0.5 * self.step_s;
        out.table.time_s.push(time_s);
        let weights = self.weights(time_s, before);
        for (column, (carry, values)) in carries.iter().zip(&mut out.table.columns).enumerate() {
            let at = |row: usize| self.raw[row].1[column];
            let value = match carry {
                Carry::Sampled if !is_near || at(near).is_nan() => f64::NAN,
                Carry::Hold => self.held_mean(column, time_s, before),
                Carry::Linear => self.knot(column, time_s),
                Carry::Smooth | Carry::Sampled => {
                    let sum: f64 = weights.iter().map(|(row, weight)| weight * at(*row)).sum();
                    let value = if sum.is_nan() { self.line(column, time_s, before) } else { sum };
                    if value.is_nan() && *carry == Carry::Sampled { at(near) } else { value }
                }
            };
            values.push(value);
        }
        if out.table.rows() >= BLOCK_ROWS {
            out.flush();
        }
    }

    /// Mean of a held input from a point of the grid to the next; it jumps at its own samples between them.
    fn held_mean(&self, column: usize, time_s: f64, before: usize) -> f64 {
        let end_s = time_s + self.step_s;
        let (mut from_s, mut value, mut sum) = (time_s, self.raw[before].1[column], 0.0);
        for (jump_s, values) in self.raw.iter().skip(before + 1).take_while(|(jump_s, _)| *jump_s < end_s) {
            sum += (jump_s - from_s) * value;
            (from_s, value) = (*jump_s, values[column]);
        }
        (sum + (end_s - from_s) * value) / self.step_s
    }

    /// Knot of a piecewise-linear input at a point of the grid. The input's own knots are at the true time stamps; straight lines
    /// between the grid's points would lose a twelfth of its second difference, which is subtracted here.
    fn knot(&self, column: usize, time_s: f64) -> f64 {
        let line = |time_s: f64| {
            let after = self.raw.partition_point(|(t, _)| *t <= time_s + 1e-9 * self.step_s);
            self.line(column, time_s, after.saturating_sub(1))
        };
        let [before, now, after] = [-1.0, 0.0, 1.0].map(|steps| line(time_s + steps * self.step_s));
        now - (before - 2.0 * now + after) / 12.0
    }

    /// Linear interpolation between the samples around a time, extrapolated beyond the ends.
    fn line(&self, column: usize, time_s: f64, before: usize) -> f64 {
        let first = before.min(self.raw.len().saturating_sub(2));
        let (from_s, from) = (self.raw[first].0, self.raw[first].1[column]);
        let Some((to_s, to)) = self.raw.get(first + 1) else { return from };
        from + (to[column] - from) * (time_s - from_s) / (to_s - from_s)
    }

    /// Samples around a time and their weights in the value there, by the polynomial of highest degree that does not enlarge noise.
    fn weights(&self, time_s: f64, before: usize) -> Vec<(usize, f64)> {
        let lagrange_weights = |side: usize| {
            let rows = (before + 1).saturating_sub(side)..(before + 1 + side).min(self.raw.len());
            let lagrange = |row: usize| {
                let own_s = self.raw[row].0;
                let others = rows.clone().filter(|other| *other != row).map(|other| self.raw[other].0);
                others.map(|other_s| (time_s - other_s) / (own_s - other_s)).product::<f64>()
            };
            rows.clone().map(|row| (row, lagrange(row))).collect::<Vec<_>>()
        };
        let size = |weights: &[(usize, f64)]| weights.iter().map(|(_, weight)| weight.abs()).sum::<f64>();
        let usable = (2..=SIDE).rev().map(lagrange_weights).find(|weights| size(weights) <= MOST_WEIGHT);
        usable.unwrap_or_else(|| lagrange_weights(1))
    }
}
