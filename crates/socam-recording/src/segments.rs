//! Segments of a recording without gaps, found in one pass.

use serde::Serialize;

use crate::clocks::median_step_s;

/// A step longer than this many sample times is a gap. Timer jitter is far below, one lost sample (2) above.
pub const GAP_STEPS: f64 = 1.5;

/// Number of steps whose median is the sample time. Gaps do not change the median unless every second step is one.
const STEPS_FOR_MEDIAN: usize = 1024;

/// Consecutive rows without a gap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Segment {
    /// Index of the first row in the dataset, from 0.
    pub first_row: u64,
    /// Number of rows, at least 1.
    pub rows: u64,
    /// Time of the first row, s.
    pub start_s: f64,
    /// Time of the last row, s.
    pub end_s: f64,
    /// Mean step between its rows, s; the recording's sample time where it has only one row.
    pub sample_time_s: f64,
    /// Largest deviation of a step from `sample_time_s`, s.
    pub jitter_s: f64,
}

impl Segment {
    /// Index of the row after its last.
    #[must_use]
    pub fn end_row(&self) -> u64 {
        self.first_row + self.rows
    }
}

/// Finds segments in one pass over the times.
#[derive(Debug)]
pub(crate) struct SegmentFinder {
    /// A step longer than this many sample times is a gap.
    gap_steps: f64,
    /// The first times, until the sample time is known.
    waiting: Vec<f64>,
    sample_time_s: Option<f64>,
    done: Vec<Segment>,
    open: Option<Open>,
    rows: u64,
}

#[derive(Debug)]
struct Open {
    first_row: u64,
    start_s: f64,
    end_s: f64,
    rows: u64,
    shortest_s: f64,
    longest_s: f64,
}

impl Open {
    fn new(first_row: u64, time_s: f64) -> Self {
        Self { first_row, start_s: time_s, end_s: time_s, rows: 1, shortest_s: f64::INFINITY, longest_s: 0.0 }
    }

    fn close(self, sample_time_s: f64) -> Segment {
        let (mean_s, jitter_s) = if self.rows > 1 {
            let mean_s = (self.end_s - self.start_s) / (self.rows - 1) as f64;
            (mean_s, (self.longest_s - mean_s).max(mean_s - self.shortest_s))
        } else {
            (sample_time_s, 0.0)
        };
        Segment {
            first_row: self.first_row,
            rows: self.rows,
            start_s: self.start_s,
            end_s: self.end_s,
            sample_time_s: mean_s,
            jitter_s,
        }
    }
}

impl SegmentFinder {
    pub(crate) fn new() -> Self {
        Self::with_gaps(GAP_STEPS)
    }

    pub(crate) fn with_gaps(gap_steps: f64) -> Self {
        Self { gap_steps, waiting: Vec::new(), sample_time_s: None, done: Vec::new(), open: None, rows: 0 }
    }

    /// Appends the next row's time, which must be later than all before.
    pub(crate) fn push(&mut self, time_s: f64) {
        if self.sample_time_s.is_some() {
            self.place(time_s);
            return;
        }
        self.waiting.push(time_s);
        if self.waiting.len() > STEPS_FOR_MEDIAN {
            self.settle();
        }
    }

    /// The segments, and the sample time (median step, s; 0 when there is only one row).
    pub(crate) fn finish(mut self) -> (Vec<Segment>, f64) {
        if self.sample_time_s.is_none() {
            self.settle();
        }
        let sample_time_s = self.sample_time_s.unwrap_or(0.0);
        if let Some(open) = self.open.take() {
            self.done.push(open.close(sample_time_s));
        }
        (self.done, sample_time_s)
    }

    fn settle(&mut self) {
        let waiting = std::mem::take(&mut self.waiting);
        self.sample_time_s = Some(median_step_s(&waiting).unwrap_or(0.0));
        for time_s in waiting {
            self.place(time_s);
        }
    }

    fn place(&mut self, time_s: f64) {
        let sample_time_s = self.sample_time_s.unwrap_or(0.0);
        let row = self.rows;
        self.rows += 1;
        let Some(open) = &mut self.open else {
            self.open = Some(Open::new(row, time_s));
            return;
        };
        let step_s = time_s - open.end_s;
        if step_s > self.gap_steps * sample_time_s {
            let closed = self.open.replace(Open::new(row, time_s));
            self.done.extend(closed.map(|open| open.close(sample_time_s)));
            return;
        }
        open.end_s = time_s;
        open.rows += 1;
        open.shortest_s = open.shortest_s.min(step_s);
        open.longest_s = open.longest_s.max(step_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(times_s: impl IntoIterator<Item = f64>) -> (Vec<Segment>, f64) {
        let mut finder = SegmentFinder::new();
        times_s.into_iter().for_each(|t| finder.push(t));
        finder.finish()
    }

    #[test]
    fn jitter_is_no_gap_and_a_lost_sample_is_one() {
        let (segments, sample_time_s) = find(
            (0..5000)
                .filter(|i| *i != 700)
                .map(|i| f64::from(i) * 1e-3 + if i % 2 == 0 { 2.4e-8 } else { 0.0 }),
        );
        assert!((sample_time_s - 1e-3).abs() < 1e-7);
        assert_eq!(segments.len(), 2);
        assert_eq!((segments[0].first_row, segments[0].rows), (0, 700));
        assert_eq!((segments[1].first_row, segments[1].rows), (700, 4299));
        assert!(segments[0].jitter_s > 1e-8 && segments[0].jitter_s < 1e-7);
        assert!((segments[1].start_s - 0.701).abs() < 1e-7);
    }

    #[test]
    fn one_row_and_none() {
        assert_eq!(find([]).0, vec![]);
        let (segments, sample_time_s) = find([3.0]);
        assert_eq!((segments.len(), segments[0].rows, sample_time_s), (1, 1, 0.0));
    }
}
