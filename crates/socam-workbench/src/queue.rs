//! Samples on their way to the window.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Samples for the window: rows with one value per channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// Time of each row since the link was opened, s.
    pub time_s: Vec<f64>,
    /// Sampling period, s.
    pub step_s: f64,
    /// Whether the board was set up before the first row: a gap before it is no loss.
    pub after_setup: bool,
    /// Where samples are missing, if the source counts them itself; `None`: a larger step of time than the period is a gap.
    pub gaps: Option<Vec<Gap>>,
    /// Row by row; NaN where there is no reading.
    pub values: Vec<f64>,
}

/// A gap in the samples, as the source counts it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gap {
    /// The row after it.
    pub row: usize,
    /// Number of rows that are missing; 0 where that is not known.
    pub missed: u64,
}

impl Batch {
    /// Appends the rows of a batch of the same source.
    fn join(&mut self, more: Batch) {
        let rows = self.time_s.len();
        if let (Some(own), Some(gaps)) = (&mut self.gaps, more.gaps) {
            own.extend(gaps.iter().map(|gap| Gap { row: rows + gap.row, ..*gap }));
        }
        self.time_s.extend(more.time_s);
        self.values.extend(more.values);
    }

    /// Counts the rows of a batch that was dropped before this one.
    fn comes_after_dropped(&mut self, dropped: &Batch) {
        let (Some(own), Some(gaps)) = (&mut self.gaps, &dropped.gaps) else { return };
        let missed = dropped.time_s.len() as u64 + gaps.iter().map(|gap| gap.missed).sum::<u64>();
        match own.first_mut() {
            Some(first) if first.row == 0 => first.missed += missed,
            _ => own.insert(0, Gap { row: 0, missed }),
        }
    }
}

/// The queue between the board's thread and the window: neither waits for the other.
///
/// Its memory is limited. While the window does not draw, the oldest samples are dropped; the window marks the gap in their times.
#[derive(Debug, Clone)]
pub struct SampleQueue {
    waiting: Arc<Mutex<Waiting>>,
    most_values: usize,
}

#[derive(Debug, Default)]
struct Waiting {
    batches: VecDeque<Batch>,
    /// Number of values in all batches.
    values: usize,
}

/// Values that wait at most: 61 s of ten channels at 10 kHz, 49 MB. The window keeps no more than its last 61 s.
const MOST_VALUES: usize = 6_100_000;

/// Batches are joined up to this number of values: what is dropped at once, and what an allocation carries.
const JOINED_VALUES: usize = 8192;

impl Default for SampleQueue {
    fn default() -> Self {
        Self::holding(MOST_VALUES)
    }
}

impl SampleQueue {
    /// A queue for this number of values.
    #[must_use]
    pub fn holding(most_values: usize) -> Self {
        Self { waiting: Arc::default(), most_values }
    }

    /// Appends samples.
    pub fn push(&self, batch: Batch) {
        let mut waiting = self.lock();
        waiting.values += batch.values.len();
        match waiting.batches.back_mut() {
            Some(last)
                if !batch.after_setup
                    && last.step_s == batch.step_s
                    && last.gaps.is_some() == batch.gaps.is_some()
                    && last.values.len() + batch.values.len() <= JOINED_VALUES =>
            {
                last.join(batch);
            }
            _ => waiting.batches.push_back(batch),
        }
        while waiting.values > self.most_values {
            let Some(dropped) = waiting.batches.pop_front() else { break };
            waiting.values -= dropped.values.len();
            if let Some(next) = waiting.batches.front_mut() {
                next.comes_after_dropped(&dropped);
            }
        }
    }

    /// Takes all that wait, oldest first.
    #[must_use]
    pub fn take(&self) -> Vec<Batch> {
        let taken = std::mem::take(&mut *self.lock());
        taken.batches.into()
    }

    /// A thread that panicked holds no half-pushed batch that matters: the picture then lacks it.
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buffer::Buffer;
    use socam_recording::{Channel, Unit};

    fn batch(ticks: std::ops::Range<u32>, step_s: f64, after_setup: bool) -> Batch {
        let time_s: Vec<f64> = ticks.map(|tick| f64::from(tick) * step_s).collect();
        Batch { values: time_s.clone(), time_s, step_s, after_setup, gaps: None }
    }

    #[test]
    fn all_samples_arrive_in_order_in_few_batches() {
        let queue = SampleQueue::default();
        (0..2000).for_each(|n| queue.push(batch(10 * n..10 * (n + 1), 1e-3, false)));
        queue.push(batch(0..10, 1e-4, false));
        queue.push(batch(10..20, 1e-4, true));
        let taken = queue.take();
        let times: Vec<f64> = taken.iter().flat_map(|batch| batch.time_s.clone()).collect();
        assert_eq!(times.len(), 20_020);
        assert!(times[..20_000].is_sorted());
        assert_eq!(taken.len(), 5, "other rates and set-ups begin a batch");
        assert!(taken[4].after_setup && queue.take().is_empty());
    }

    #[test]
    fn gaps_that_a_source_counts_are_kept_when_batches_are_joined_or_dropped() {
        let queue = SampleQueue::holding(20_000);
        let mut buffer = Buffer::new(vec![Channel::new("a", Unit::V)]);
        let counted = |ticks, gap: Option<Gap>| Batch {
            gaps: Some(gap.into_iter().collect()),
            step_s: 0.0,
            ..batch(ticks, 1e-3, false)
        };
        queue.push(counted(0..10, None));
        // An uneven step is no gap where the source counts its rows.
        queue.push(counted(13..20, None));
        queue.push(counted(30..40, Some(Gap { row: 4, missed: 2 })));
        queue.take().iter().for_each(|batch| buffer.take(batch));
        assert_eq!((buffer.missed(), buffer.holes().len()), ([2, 1], 1));
        assert_eq!(buffer.holes()[0].span, [0.033, 0.034]);
        (4..10_000).for_each(|n| queue.push(counted(10 * n..10 * (n + 1), None)));
        queue.take().iter().for_each(|batch| buffer.take(batch));
        assert_eq!(buffer.missed()[1], 2);
        assert_eq!(buffer.missed()[0] + (buffer.rows() as u64), 27 + 2 + 99_960);
    }

    #[test]
    fn memory_is_limited_the_oldest_go_first_and_the_gap_is_marked() {
        let queue = SampleQueue::holding(20_000);
        let mut buffer = Buffer::new(vec![Channel::new("a", Unit::V)]);
        let push = |ticks: std::ops::Range<u32>| {
            ticks.for_each(|n| queue.push(batch(10 * n..10 * (n + 1), 1e-4, false)));
        };
        push(0..10);
        queue.take().iter().for_each(|batch| buffer.take(batch));
        // The window hangs for ten seconds at 10 kHz.
        push(10..10_000);
        queue.take().iter().for_each(|batch| buffer.take(batch));
        let [missed, gaps] = buffer.missed();
        assert!((10_000..=20_100).contains(&buffer.rows()), "{}", buffer.rows());
        assert_eq!((buffer.rows() as u64 + missed, gaps), (100_000, 1));
        assert_eq!(buffer.holes()[0].missed, missed);
    }
}
