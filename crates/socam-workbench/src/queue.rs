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
    /// Row by row; NaN where there is no reading.
    pub values: Vec<f64>,
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
                    && last.values.len() + batch.values.len() <= JOINED_VALUES =>
            {
                last.time_s.extend(batch.time_s);
                last.values.extend(batch.values);
            }
            _ => waiting.batches.push_back(batch),
        }
        while waiting.values > self.most_values {
            let Some(dropped) = waiting.batches.pop_front() else { break };
            waiting.values -= dropped.values.len();
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
        Batch { values: time_s.clone(), time_s, step_s, after_setup }
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
