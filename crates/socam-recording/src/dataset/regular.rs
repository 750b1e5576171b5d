//! Irregular time stamps: a recording carried over to a regular grid.
//!
//! The grid's step is the median step or a whole part of it. Inputs are interpolated at their true time stamps, each as it moves
//! between them. Every other sample goes to the grid's nearest point, by the polynomial through its neighbours, and the grid's
//! points without a sample miss that value. Steps longer than [`BRIDGED`] median steps stay gaps.

use std::collections::VecDeque;

use super::keep::{Keeping, Kept};
use super::scan::Tally;
use super::{BLOCK_ROWS, Dataset, Source, SpillSource, Warning};
use crate::Channel;
use crate::error::{RecordingError, Result};
use crate::table::Table;

/// A step that differs from the median by more than this share of it is irregular.
const UNEVEN: f64 = 0.05;
/// Share of irregular steps from which on a recording's time stamps are.
const IRREGULAR: f64 = 0.02;
/// Longest step that is interpolated over, in median steps.
const BRIDGED: f64 = 4.0;
/// Samples on either side that a value is interpolated from.
const SIDE: usize = 3;
/// Sum of the weights' magnitudes beyond which a polynomial would enlarge noise: then one of lower degree is taken.
const MOST_WEIGHT: f64 = 2.0;

/// How a channel is carried over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carry {
    /// The mean of what is held up to the next point.
    Hold,
    /// In straight lines.
    Linear,
    /// By the polynomial of fifth degree through the samples about it.
    Smooth,
    /// Only to the point nearest to each sample, by that polynomial.
    Sampled,
}

/// The steps of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steps {
    /// Median, s.
    pub median_s: f64,
    /// Shortest and longest, s.
    pub range_s: (f64, f64),
    /// Steps that differ from the median, but are no gap on a regular grid.
    pub irregular: u64,
    /// All.
    pub count: u64,
}

impl Steps {
    /// Whether time stamps are too irregular to take them for a steady rate.
    #[must_use]
    pub fn are_irregular(&self) -> bool {
        self.irregular as f64 > IRREGULAR * self.count as f64
    }
}

impl Dataset {
    /// Its steps, in one pass over the times.
    ///
    /// # Errors
    /// When the file cannot be read again.
    pub fn steps(&self) -> Result<Steps> {
        let median_s = self.sample_time_s;
        let mut steps = Steps {
            median_s,
            range_s: (f64::INFINITY, 0.0),
            irregular: 0,
            count: self.rows.saturating_sub(1),
        };
        let mut last = None;
        for block in self.blocks_in(0..self.rows, &[])? {
            for time_s in block?.time_s {
                if let Some(last) = last.replace(time_s) {
                    let step_s: f64 = time_s - last;
                    steps.range_s = (steps.range_s.0.min(step_s), steps.range_s.1.max(step_s));
                    // A lost sample leaves a step of two.
                    let whole = (step_s / median_s).round().max(1.0);
                    steps.irregular += u64::from((step_s - whole * median_s).abs() > UNEVEN * median_s);
                }
            }
        }
        Ok(steps)
    }

    /// The recording on a regular grid of `parts` points a median step; `carry` says how each channel goes there.
    ///
    /// # Errors
    /// When the recording cannot be read again, or there is room for the grid neither in memory nor on disk.
    pub fn on_regular_grid(&self, parts: u32, carry: impl Fn(&Channel) -> Carry) -> Result<Self> {
        let steps = self.steps()?;
        let median_s = steps.median_s;
        let step_s = median_s / f64::from(parts.max(1));
        let carries: Vec<Carry> = self.channels.iter().map(carry).collect();
        let mut out = Out {
            tally: Tally::new(carries.len()),
            kept: Keeping::with_columns(carries.len()),
            table: Table::with_columns(carries.len()),
            expected: ((self.end_s() - self.start_s()) / step_s) as u64,
        };
        let mut run: Option<Run> = None;
        let mut gaps = 0;
        for block in self.blocks()? {
            let block = block?;
            for (row, time_s) in block.time_s.iter().enumerate() {
                let values: Vec<f64> = block.columns.iter().map(|column| column.values()[row]).collect();
                if let Some(open) = run.take_if(|run| *time_s - run.last_s() > BRIDGED * median_s) {
                    open.finish(&carries, &mut out);
                    gaps += 1;
                }
                let run = run.get_or_insert_with(|| Run::new(*time_s, step_s));
                run.raw.push_back((*time_s, values));
                run.advance(&carries, &mut out);
            }
        }
        if let Some(open) = run {
            open.finish(&carries, &mut out);
        }
        self.carried(out, steps, (parts, step_s), gaps)
    }

    fn carried(&self, mut out: Out, steps: Steps, (parts, step_s): (u32, f64), gaps: u64) -> Result<Self> {
        out.flush();
        let Out { tally, kept, .. } = out;
        let rows = tally.rows;
        let (segments, sample_time_s) = tally.finder.finish();
        let source = match kept.finish() {
            Kept::Memory(memory) => Source::Memory(memory.into()),
            Kept::Spill(spill) => {
                Source::Spill(SpillSource { spill, columns: (0..self.channels.len()).collect() }.into())
            }
            Kept::Nothing => {
                let problem = "there is room neither in memory nor on disk for its regular grid".into();
                return Err(RecordingError::Table { name: self.name.clone(), problem });
            }
        };
        let (least_ms, most_ms) = (1e3 * steps.range_s.0, 1e3 * steps.range_s.1);
        let mut warnings = self.warnings.clone();
        warnings.push(Warning::Note(format!(
            "its time stamps are irregular (steps of {least_ms:.3} to {most_ms:.3} ms, half of them below {:.3} ms): it was put on a grid of {:.3} ms, inputs interpolated and every other sample shifted to the nearest point along its own curve; {gaps} steps above {:.1} ms are left as gaps",
            1e3 * steps.median_s,
            1e3 * step_s,
            1e3 * BRIDGED * steps.median_s,
        )));
        Ok(Self {
            statistics: tally.running.into_iter().map(crate::statistics::Running::finish).collect(),
            segments,
            sample_time_s,
            rows,
            parts,
            warnings,
            source,
            ..self.clone()
        })
    }
}

/// Where the grid's rows go.
struct Out {
    tally: Tally,
    kept: Keeping,
    table: Table,
    expected: u64,
}

impl Out {
    fn flush(&mut self) {
        self.tally.take(&self.table);
        self.kept.append(&self.table, self.expected);
        self.table.clear();
    }
}

/// Samples without a gap, as far as points of the grid still need them.
struct Run {
    raw: VecDeque<(f64, Vec<f64>)>,
    start_s: f64,
    step_s: f64,
    /// Points of the grid that are done.
    done: u64,
}

impl Run {
    fn new(start_s: f64, step_s: f64) -> Self {
        Self { raw: VecDeque::new(), start_s, step_s, done: 0 }
    }

    fn last_s(&self) -> f64 {
        self.raw.back().map_or(self.start_s, |(time_s, _)| *time_s)
    }

    fn next_s(&self) -> f64 {
        self.start_s + self.done as f64 * self.step_s
    }

    /// Does the points that have enough samples after them.
    fn advance(&mut self, carries: &[Carry], out: &mut Out) {
        let Some(known) = self.raw.len().checked_sub(SIDE + 2) else { return };
        while self.next_s() <= self.raw[known].0 {
            self.point(carries, out);
        }
        // As many before the next point as it needs, and one that may lie nearest to it.
        let next_s = self.next_s();
        while self.raw.len() > SIDE + 2 && self.raw[SIDE + 1].0 < next_s {
            self.raw.pop_front();
        }
    }

    fn finish(mut self, carries: &[Carry], out: &mut Out) {
        while self.next_s() <= self.last_s() {
            self.point(carries, out);
        }
    }

    fn point(&mut self, carries: &[Carry], out: &mut Out) {
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

    /// Mean of a held input up to the grid's next point: its jumps lie between points.
    fn held_mean(&self, column: usize, time_s: f64, before: usize) -> f64 {
        let end_s = time_s + self.step_s;
        let (mut from_s, mut value, mut sum) = (time_s, self.raw[before].1[column], 0.0);
        for (jump_s, values) in self.raw.iter().skip(before + 1).take_while(|(jump_s, _)| *jump_s < end_s) {
            sum += (jump_s - from_s) * value;
            (from_s, value) = (*jump_s, values[column]);
        }
        (sum + (end_s - from_s) * value) / self.step_s
    }

    /// Value of a line with bends at the true time stamps, moved by what straight lines between the grid's points would lose of it: a
    /// twelfth of its second difference.
    fn knot(&self, column: usize, time_s: f64) -> f64 {
        let line = |time_s: f64| {
            let after = self.raw.partition_point(|(t, _)| *t <= time_s + 1e-9 * self.step_s);
            self.line(column, time_s, after.saturating_sub(1))
        };
        let [before, now, after] = [-1.0, 0.0, 1.0].map(|steps| line(time_s + steps * self.step_s));
        now - (before - 2.0 * now + after) / 12.0
    }

    /// On the straight line through the samples about a time; beyond the ends it goes on.
    fn line(&self, column: usize, time_s: f64, before: usize) -> f64 {
        let first = before.min(self.raw.len().saturating_sub(2));
        let (from_s, from) = (self.raw[first].0, self.raw[first].1[column]);
        let Some((to_s, to)) = self.raw.get(first + 1) else { return from };
        from + (to[column] - from) * (time_s - from_s) / (to_s - from_s)
    }

    /// Samples about a time, and what each contributes to the value there: of the highest polynomial that does not enlarge noise.
    fn weights(&self, time_s: f64, before: usize) -> Vec<(usize, f64)> {
        let of_side = |side: usize| {
            let rows = (before + 1).saturating_sub(side)..(before + 1 + side).min(self.raw.len());
            let lagrange = |row: usize| {
                let own_s = self.raw[row].0;
                let others = rows.clone().filter(|other| *other != row).map(|other| self.raw[other].0);
                others.map(|other_s| (time_s - other_s) / (own_s - other_s)).product::<f64>()
            };
            rows.clone().map(|row| (row, lagrange(row))).collect::<Vec<_>>()
        };
        let size = |weights: &[(usize, f64)]| weights.iter().map(|(_, weight)| weight.abs()).sum::<f64>();
        let usable = (2..=SIDE).rev().map(of_side).find(|weights| size(weights) <= MOST_WEIGHT);
        usable.unwrap_or_else(|| of_side(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Unit;

    fn motion(t: f64) -> f64 {
        3.0 * (60.0 * t).sin() + 2.0 * t
    }

    /// Stamps that jitter by 30 %, some samples lost, and a pause.
    fn jittered(rows: usize) -> Dataset {
        let mut random = 7_u64;
        let mut draw = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 11) as f64 / (1_u64 << 53) as f64
        };
        let all = (0..rows).map(|k| {
            let pause_s = if k >= rows / 2 { 0.05 } else { 0.0 };
            (1e-3 * (k as f64 + 0.6 * (draw() - 0.5)) + pause_s, draw())
        });
        let kept: Vec<f64> = all.filter(|(_, keep)| *keep > 0.05).map(|(t, _)| t).collect();
        let channels = ["held", "line", "motion", "seen"].map(|name| Channel::new(name, Unit::Nm)).to_vec();
        let motion: Vec<f64> = kept.iter().map(|t| motion(*t)).collect();
        let line = kept.iter().map(|t| 5.0 * t).collect();
        Dataset::from_columns("jittered", channels, kept, vec![motion.clone(), line, motion.clone(), motion])
            .unwrap()
    }

    #[test]
    fn a_jittered_recording_lies_on_its_curve_everywhere() {
        let raw = jittered(20_000);
        assert!(raw.steps().unwrap().are_irregular() && raw.segments().len() > 100);
        let carry = |channel: &Channel| match channel.name.as_str() {
            "held" => Carry::Hold,
            "line" => Carry::Linear,
            "motion" => Carry::Smooth,
            _ => Carry::Sampled,
        };
        for parts in [1, 4] {
            let grid = raw.on_regular_grid(parts, carry).unwrap();
            assert_eq!(grid.segments().len(), 2);
            assert!(grid.segments().iter().all(|segment| segment.jitter_s < 1e-9));
            let told = grid.warnings().last().unwrap().to_string();
            assert!(told.contains("1 steps above"), "{told}");
            let loaded = grid.load(&["held", "line", "motion", "seen"]).unwrap();
            let (mut seen, mut worst, mut worst_seen, mut squares) = (0, 0.0_f64, 0.0_f64, 0.0);
            for (row, t) in loaded.time_s.iter().enumerate() {
                let at = |column: usize| loaded.columns[column].values()[row];
                assert!((at(0) - motion(*t)).abs() < 0.7);
                assert!((at(1) - 5.0 * t).abs() < 1e-9);
                worst = worst.max((at(2) - motion(*t)).abs());
                squares += (at(2) - motion(*t)).powi(2);
                if !at(3).is_nan() {
                    worst_seen = worst_seen.max((at(3) - motion(*t)).abs());
                    seen += 1;
                }
            }
            let rms = (squares / loaded.time_s.len() as f64).sqrt();
            // Of an amplitude of 3; worst beside several lost samples.
            assert!(worst < 0.03 && worst_seen < 6e-3 && rms < 1e-3, "{worst} {worst_seen} {rms}");
            let share = f64::from(seen) / raw.rows() as f64;
            assert!(share > if parts == 1 { 0.85 } else { 0.995 }, "{share}");
        }
    }

    #[test]
    fn a_steady_rate_with_lost_samples_is_regular() {
        let time_s: Vec<f64> = (0..5000)
            .filter(|k| k % 17 != 0)
            .map(|k| f64::from(k) * 1e-3 + 2e-6 * f64::from(k % 3))
            .collect();
        let values = vec![time_s.clone()];
        let data =
            Dataset::from_columns("steady", vec![Channel::new("a", Unit::Nm)], time_s, values).unwrap();
        assert!(!data.steps().unwrap().are_irregular());
    }
}
