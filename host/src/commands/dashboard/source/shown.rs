//! Samples of a source for the window, with what is missing between them.

use socam_workbench::queue::{Batch, Gap, SampleQueue};

use crate::device::source::Row;

/// Shortest pause that is shown as a gap where nothing is known to be missing, ns, and as a multiple of the usual step.
const PAUSE_NS: i64 = 200_000_000;
const PAUSE_STEPS: f64 = 10.0;
/// Weight of a step in the usual one.
const WEIGHT: f64 = 0.05;

/// The rows that were shown.
pub(super) struct Shown {
    samples: SampleQueue,
    /// Time of the first row since the link was opened, ns.
    first_ns: Option<i64>,
    /// Time and number of the last row.
    last: Option<(i64, u64)>,
    /// The usual step, ns.
    usual_ns: Option<f64>,
    was_interrupted: bool,
    /// Number of values of a row: those that a row has not are missing.
    width: usize,
    /// Rows that arrived.
    pub(super) received: u64,
    /// Rows that are missing.
    pub(super) lost: u64,
}

impl Shown {
    /// `width`: number of channels.
    pub(super) fn new(samples: SampleQueue, width: usize) -> Self {
        Self {
            samples,
            width,
            first_ns: None,
            last: None,
            usual_ns: None,
            was_interrupted: false,
            received: 0,
            lost: 0,
        }
    }

    /// The link broke: a gap is before the next row.
    pub(super) fn interrupted(&mut self) {
        self.was_interrupted = self.last.is_some();
    }

    /// The time since the first row, ns, of one that arrives at this time, and the number that follows the last one.
    pub(super) fn next(&self, arrival_ns: i64) -> (i64, u64) {
        let time_ns = arrival_ns - self.first_ns.unwrap_or(arrival_ns);
        self.last.map_or((time_ns, 0), |(last_ns, sequence)| (time_ns.max(last_ns + 1000), sequence + 1))
    }

    /// Time of a row since the link was opened, s.
    pub(super) fn time_of(&self, row: &Row) -> f64 {
        (self.first_ns.unwrap_or(row.arrival_ns) + row.time_ns) as f64 * 1e-9
    }

    /// Time of the latest row since the link was opened, s.
    pub(super) fn time_s(&self) -> f64 {
        self.first_ns
            .zip(self.last)
            .map_or(0.0, |(first_ns, (last_ns, _))| (first_ns + last_ns) as f64 * 1e-9)
    }

    /// Shows rows.
    pub(super) fn take(&mut self, rows: Vec<Row>) {
        let Some(first) = rows.first() else { return };
        self.first_ns.get_or_insert(first.arrival_ns);
        let mut batch = Batch {
            time_s: Vec::with_capacity(rows.len()),
            step_s: 0.0,
            after_setup: false,
            gaps: None,
            values: Vec::new(),
        };
        let mut gaps = Vec::new();
        for (index, row) in rows.into_iter().enumerate() {
            if let Some(missed) = self.missed(&row) {
                gaps.push(Gap { row: index, missed });
                self.lost += missed;
            }
            self.received += 1;
            self.last = Some((row.time_ns, row.sequence));
            batch.time_s.push(self.time_of(&row));
            let missing = self.width.saturating_sub(row.values.len());
            batch.values.extend(row.values);
            batch.values.extend(std::iter::repeat_n(f64::NAN, missing));
        }
        batch.gaps = Some(gaps);
        self.samples.push(batch);
    }

    /// Number of rows that are missing before a row, 0 if that is not known; `None` if there is no gap.
    fn missed(&mut self, row: &Row) -> Option<u64> {
        let (last_ns, sequence) = self.last?;
        let step_ns = row.time_ns - last_ns;
        let missed = row.sequence.saturating_sub(sequence.saturating_add(1));
        let usual_ns = self.usual_ns.unwrap_or(step_ns as f64);
        let is_pause = step_ns > PAUSE_NS && step_ns as f64 > PAUSE_STEPS * usual_ns;
        let was_interrupted = std::mem::take(&mut self.was_interrupted);
        if missed > 0 || is_pause || was_interrupted {
            return Some(missed);
        }
        self.usual_ns = Some(usual_ns + WEIGHT * (step_ns as f64 - usual_ns));
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time_ms: i64, sequence: u64) -> Row {
        let (time_ns, arrival_ns) = (1_000_000 * time_ms, 1_000_000 * (time_ms + 500));
        Row { time_ns, sequence, arrival_ns, has_clock: true, is_new_clock: false, values: vec![1.0] }
    }

    #[test]
    fn what_is_missing_a_pause_and_an_interruption_are_gaps_and_unsteady_arrival_is_none() {
        let queue = SampleQueue::default();
        let mut shown = Shown::new(queue.clone(), 1);
        shown.interrupted();
        shown.take((0..50).map(|k| row(10 * k + 7 * (k % 2), k as u64)).collect());
        shown.take(vec![row(520, 53)]);
        shown.interrupted();
        shown.take(vec![row(530, 54), row(900, 55), row(910, 56)]);
        let batches = queue.take();
        let gaps: Vec<Gap> = batches.iter().flat_map(|batch| batch.gaps.clone().unwrap()).collect();
        let gap = |row, missed| Gap { row, missed };
        assert_eq!(gaps, [gap(50, 3), gap(51, 0), gap(52, 0)]);
        assert_eq!((shown.received, shown.lost), (54, 3));
        assert!((shown.time_s() - 1.41).abs() < 1e-9, "since the link was opened: {}", shown.time_s());
    }
}
