//! Rows out of frames or messages that come at different rates: a row for each frame of the fastest kind, at its time.
//!
//! Values of the other kinds are interpolated between the frames before and after the row, over 2.5 of their usual steps at most. Those of a kind
//! that is three times slower or more are put at the nearest row alone. What is not known is NaN. `socam_import` does alike with logs.

use std::collections::VecDeque;

/// Longest step that is interpolated over, in usual steps of the kind.
const BRIDGED: f64 = 2.5;
/// Ratio of a kind's step to that of the rows from which its values stand at the nearest row alone.
const SLOW: f64 = 3.0;
/// Longest time by which a slow value comes before its row, in steps of the rows.
const LATE: f64 = 1.5;
/// Most rows that wait for the frames behind them.
const MOST_WAITING: usize = 4096;

/// A kind of frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Kind {
    /// Usual time between its frames, s.
    pub step_s: f64,
    /// Number of its values.
    pub width: usize,
}

/// A frame of a kind that is not the fastest.
type Sample = (f64, Vec<f64>);

/// Puts frames of kinds together; the first kind gives the rows.
#[derive(Debug)]
pub struct Aligner {
    kinds: Vec<Kind>,
    last: Vec<Option<Sample>>,
    waiting: VecDeque<Waiting>,
    /// Values of slow kinds that came before the row that they belong to.
    early: Vec<Option<Sample>>,
}

/// A row whose values may still come.
#[derive(Debug)]
struct Waiting {
    time_s: f64,
    values: Vec<Option<Vec<f64>>>,
    /// What is handed on with the row.
    mark: i64,
}

impl Aligner {
    /// Puts together frames of these kinds, the fastest one first.
    #[must_use]
    pub fn new(kinds: Vec<Kind>) -> Self {
        let count = kinds.len();
        Self { kinds, last: vec![None; count], waiting: VecDeque::new(), early: vec![None; count] }
    }

    fn is_slow(&self, kind: usize) -> bool {
        self.kinds[kind].step_s >= SLOW * self.kinds[0].step_s
    }

    /// Takes a frame of a kind, and hands on the rows that are complete: time, s, values of all kinds, and the mark of their frame.
    pub fn push(
        &mut self,
        kind: usize,
        time_s: f64,
        values: Vec<f64>,
        mark: i64,
        mut take: impl FnMut(f64, Vec<f64>, i64),
    ) {
        if kind == 0 {
            self.begin_row(time_s, values, mark);
        } else if self.is_slow(kind) {
            self.put(kind, time_s, values);
        } else {
            self.interpolate(kind, time_s, values);
        }
        let newest_s = time_s;
        while let Some(first) = self.waiting.front() {
            let is_full = self.waiting.len() > MOST_WAITING;
            let is_complete = (1..self.kinds.len()).all(|other| {
                let reach_s = if self.is_slow(other) {
                    0.5 * self.kinds[0].step_s
                } else {
                    BRIDGED * self.kinds[other].step_s
                };
                first.values[other].is_some() || newest_s - first.time_s > reach_s
            });
            if !is_complete && !is_full {
                break;
            }
            let Some(row) = self.waiting.pop_front() else { break };
            let filled = row.values.into_iter().zip(&self.kinds);
            let values =
                filled.flat_map(|(values, kind)| values.unwrap_or_else(|| vec![f64::NAN; kind.width]));
            take(row.time_s, values.collect(), row.mark);
        }
    }

    fn begin_row(&mut self, time_s: f64, values: Vec<f64>, mark: i64) {
        let mut row = vec![None; self.kinds.len()];
        row[0] = Some(values);
        for (kind, place) in row.iter_mut().enumerate().skip(1) {
            // A slow value that was nearer to this row than to the one before it.
            let early = self.early[kind].take();
            let early = early.filter(|(early_s, _)| time_s - early_s <= LATE * self.kinds[0].step_s);
            let same = || self.last[kind].clone().filter(|(last_s, _)| *last_s == time_s);
            *place = early.or_else(same).map(|(_, values)| values);
        }
        self.waiting.push_back(Waiting { time_s, values: row, mark });
    }

    /// Puts a value at the nearest row, of those that wait or the next one.
    fn put(&mut self, kind: usize, time_s: f64, values: Vec<f64>) {
        let reach_s = 0.5 * self.kinds[0].step_s;
        let near = self.waiting.iter_mut().rev().find(|row| (row.time_s - time_s).abs() <= reach_s);
        match near {
            Some(row) => row.values[kind] = Some(values),
            None => self.early[kind] = Some((time_s, values)),
        }
    }

    /// Fills the rows between the frame before and this one.
    fn interpolate(&mut self, kind: usize, time_s: f64, values: Vec<f64>) {
        if let Some((before_s, before)) = &self.last[kind] {
            let step_s = time_s - before_s;
            let is_bridged = step_s > 0.0 && step_s <= BRIDGED * self.kinds[kind].step_s;
            let within =
                self.waiting.iter_mut().filter(|row| row.time_s >= *before_s && row.time_s <= time_s);
            for row in within.filter(|_| is_bridged) {
                let share = (row.time_s - before_s) / step_s;
                let between =
                    before.iter().zip(&values).map(|(before, after)| before + share * (after - before));
                row.values[kind] = Some(between.collect());
            }
        }
        self.last[kind] = Some((time_s, values));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(kinds: [f64; 2], frames: &[(usize, f64, f64)]) -> Vec<(f64, f64, f64)> {
        let mut aligner = Aligner::new(kinds.map(|step_s| Kind { step_s, width: 1 }).to_vec());
        let mut all = Vec::new();
        for (kind, time_s, value) in frames {
            aligner.push(*kind, *time_s, vec![*value], 0, |time_s, values, _| {
                all.push((time_s, values[0], values[1]))
            });
        }
        all
    }

    #[test]
    fn a_kind_of_similar_rate_is_interpolated_at_the_times_of_rows() {
        let frames = [
            (0, 0.0, 1.0),
            (1, 0.5, 10.0),
            (0, 1.0, 2.0),
            (1, 1.5, 20.0),
            (0, 2.0, 3.0),
            (1, 2.5, 30.0),
            (0, 6.0, 4.0),
        ];
        let rows = rows([1.0, 1.0], &frames);
        assert_eq!(rows[1..], [(1.0, 2.0, 15.0), (2.0, 3.0, 25.0)]);
        // Nothing is known before its first frame, nor behind a hole.
        assert!(rows[0].2.is_nan() && rows.len() == 3);
        let hole = [
            (0, 0.0, 1.0),
            (1, 0.0, 1.0),
            (0, 1.0, 1.0),
            (0, 2.0, 1.0),
            (0, 3.0, 1.0),
            (0, 4.0, 1.0),
            (1, 4.1, 2.0),
            (0, 6.0, 1.0),
        ];
        let rows = super::tests::rows([1.0, 1.0], &hole);
        assert!(rows[1..4].iter().all(|row| row.2.is_nan()), "{rows:?}");
    }

    #[test]
    fn a_slow_kind_stands_at_the_nearest_row_alone() {
        let mut frames = vec![(1, -0.3, 5.0)];
        for k in 0..10 {
            frames.push((0, f64::from(k), 1.0));
            if k == 4 {
                frames.push((1, 4.2, 6.0));
            }
        }
        let rows = rows([1.0, 5.0], &frames);
        let held: Vec<f64> = rows.iter().filter(|row| !row.2.is_nan()).map(|row| row.0).collect();
        assert_eq!(held, [0.0, 4.0]);
    }
}
