//! Rows of several devices in the order of their times, and put together at the times of the fastest one.

use std::collections::VecDeque;

use socam_sources::{Aligner, Kind};

/// Longest time for which a row waits for those of other devices, ns: longer than links and this computer usually delay one.
const WAIT_NS: i64 = 500_000_000;

/// A row of all devices.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Merged {
    /// Time since the recorder began, ns.
    pub(super) time_ns: i64,
    /// Number of the row of the fastest device.
    pub(super) sequence: u64,
    /// Values of the fastest device, then of the others.
    pub(super) values: Vec<f64>,
}

struct Waiting {
    time_ns: i64,
    sequence: u64,
    values: Vec<f64>,
}

/// Puts rows together.
pub(super) struct Merge {
    /// Devices, the fastest one first.
    order: Vec<usize>,
    /// Rows of each device that wait.
    queues: Vec<VecDeque<Waiting>>,
    widths: Vec<usize>,
    aligner: Aligner,
    /// Time of the last row that was handed on, ns.
    last_ns: i64,
}

impl Merge {
    /// Of devices with these usual steps, s, and numbers of channels.
    pub(super) fn new(steps_s: &[f64], widths: &[usize]) -> Self {
        let mut order: Vec<usize> = (0..steps_s.len()).collect();
        order.sort_by(|a, b| steps_s[*a].total_cmp(&steps_s[*b]));
        let kinds =
            order.iter().map(|device| Kind { step_s: steps_s[*device], width: widths[*device] }).collect();
        let queues = order.iter().map(|_| VecDeque::new()).collect();
        Self { order, queues, widths: widths.to_vec(), aligner: Aligner::new(kinds), last_ns: i64::MIN }
    }

    /// The devices in the order of the values, the fastest one first.
    pub(super) fn order(&self) -> &[usize] {
        &self.order
    }

    /// Takes a row of a device.
    pub(super) fn push(&mut self, device: usize, time_ns: i64, sequence: u64, values: Vec<f64>) {
        self.queues[device].push_back(Waiting { time_ns, sequence, values });
    }

    /// Hands on the rows that no earlier one can come before any more, or that have waited long enough.
    pub(super) fn take_due<E>(
        &mut self,
        now_ns: i64,
        take: impl FnMut(Merged) -> Result<(), E>,
    ) -> Result<(), E> {
        self.hand_on(now_ns.saturating_sub(WAIT_NS), take)
    }

    /// Hands on all rows.
    pub(super) fn finish<E>(&mut self, mut take: impl FnMut(Merged) -> Result<(), E>) -> Result<(), E> {
        self.hand_on(i64::MAX, &mut take)?;
        // A value of the second device that never comes completes the rows that wait for one.
        let Some(second) = self.order.get(1) else { return Ok(()) };
        let nothing = vec![f64::NAN; self.widths[*second]];
        self.align(1, f64::INFINITY, nothing, 0, &mut take)
    }

    fn hand_on<E>(&mut self, until_ns: i64, mut take: impl FnMut(Merged) -> Result<(), E>) -> Result<(), E> {
        loop {
            let heads = self.queues.iter().map(|queue| queue.front().map(|row| row.time_ns));
            let earliest = heads.clone().enumerate().filter_map(|(device, head)| Some((head?, device))).min();
            let Some((time_ns, device)) = earliest else { return Ok(()) };
            if time_ns >= until_ns && heads.clone().any(|head| head.is_none()) {
                return Ok(());
            }
            let Some(row) = self.queues[device].pop_front() else { return Ok(()) };
            let kind = self.order.iter().position(|own| *own == device).unwrap_or(0);
            if kind == 0 {
                if row.time_ns <= self.last_ns {
                    continue;
                }
                self.last_ns = row.time_ns;
            }
            self.align(kind, row.time_ns as f64 * 1e-9, row.values, row.sequence, &mut take)?;
        }
    }

    fn align<E>(
        &mut self,
        kind: usize,
        time_s: f64,
        values: Vec<f64>,
        sequence: u64,
        mut take: impl FnMut(Merged) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut outcome = Ok(());
        self.aligner.push(kind, time_s, values, sequence as i64, |time_s, values, mark| {
            if outcome.is_ok() {
                let (time_ns, sequence) = ((time_s * 1e9).round() as i64, mark as u64);
                outcome = take(Merged { time_ns, sequence, values });
            }
        });
        outcome
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device at 1 kHz and one at 500 Hz whose rows arrive 60 ms late: values are those of the row's time.
    #[test]
    fn rows_are_put_together_at_the_times_of_the_fastest_device_however_late_the_others_come() {
        let mut merge = Merge::new(&[0.002, 0.001], &[1, 1]);
        assert_eq!(merge.order(), [1, 0]);
        let mut rows = Vec::new();
        let mut take = |row: Merged| -> Result<(), ()> {
            rows.push(row);
            Ok(())
        };
        for ms in 0..1000_i64 {
            merge.push(1, 1_000_000 * ms, ms as u64, vec![ms as f64]);
            let late = ms - 60;
            if late >= 0 && late % 2 == 0 {
                merge.push(0, 1_000_000 * late + 300_000, late as u64 / 2, vec![late as f64 + 0.3]);
            }
            merge.take_due(1_000_000 * ms, &mut take).unwrap();
        }
        merge.finish(&mut take).unwrap();
        assert_eq!(rows.len(), 1000);
        assert!(rows.iter().enumerate().all(|(index, row)| row.sequence == index as u64));
        let both = rows.iter().filter(|row| row.values[1].is_finite());
        assert!(both.clone().count() > 930, "{}", both.count());
        assert!(both.clone().all(|row| (row.values[0] - row.values[1]).abs() < 1e-9));
    }

    /// A device that falls silent holds nothing back for longer than the wait.
    #[test]
    fn a_silent_device_leaves_its_values_missing() {
        let mut merge = Merge::new(&[0.001, 0.001], &[1, 2]);
        let mut rows = Vec::new();
        let mut take = |row: Merged| -> Result<(), ()> {
            rows.push(row);
            Ok(())
        };
        for ms in 0..2000_i64 {
            merge.push(0, 1_000_000 * ms, ms as u64, vec![1.0]);
            if ms < 500 {
                merge.push(1, 1_000_000 * ms, ms as u64, vec![2.0, 3.0]);
            }
            merge.take_due(1_000_000 * ms, &mut take).unwrap();
        }
        assert!((1490..1510).contains(&rows.len()), "{}", rows.len());
        assert_eq!(rows[100].values, [1.0, 2.0, 3.0]);
        assert!(rows[1000].values[1].is_nan() && rows[1000].values[0] == 1.0);
    }
}
