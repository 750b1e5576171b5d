//! Times and numbers of rows.
//!
//! A row of a device with a clock keeps that clock: the first row is at 0, and the distance between rows is the device's own. The host's
//! clock only judges it. A clock that jumps or starts anew is tied to the host's clock again at that row.

use crate::device::{Numbering, Row};

mod clock_map;
mod period;

pub use clock_map::ClockMap;
use clock_map::Lags;
use period::Period;

/// What was counted beside the rows that are placed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rows that came again and were left out.
    pub repeated: u64,
    /// Rows that came after a newer one and were left out.
    pub late: u64,
    /// Times at which the device's clock or number jumped or began anew.
    pub jumps: u64,
    /// Damaged messages.
    pub damaged: u64,
}

/// What becomes of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placed {
    /// It is recorded.
    At {
        /// Time since the first row, ns.
        time_ns: i64,
        /// Number; a jump means lost rows.
        sequence: u64,
        /// Whether the device's clock jumped before it, so that the step from the row before is by the host's clock.
        jumped: bool,
    },
    /// It is the row before once more.
    Repeated,
    /// A newer row came before it.
    Late,
}

/// Lag, ns, by which the device's clock may run ahead of the host's at once before it counts as a jump: the first rows may have waited
/// in buffers that long.
const AHEAD_NS: i64 = 1_000_000_000;
/// Rows in a row that seem late before the clock is taken to have begun anew.
const LATE_ROWS: u32 = 16;
/// Most rows that are lost at once; a larger step of the device's number is a jump of it.
const MOST_LOST: u64 = 1_000_000;
/// Longest tick of a device's clock, ns of the host's: a clock that shows the same time in [`LATE_ROWS`] rows beyond it has stopped.
const TICK_NS: i64 = 250_000_000;
/// Longest time by which a row may be overtaken, ns.
const OVERTAKEN_NS: i64 = 1_000_000_000;

/// Gives rows their times and numbers.
#[derive(Debug)]
pub struct Timeline {
    numbering: Numbering,
    /// Range of the device's clock, s, after which it begins anew.
    wrap_s: Option<f64>,
    last: Option<Last>,
    late_in_a_row: u32,
    /// Arrival of the first row of the device's present tick, rows that came long after it, and whether its clock has stopped.
    tick_ns: i64,
    still_rows: u32,
    is_stopped: bool,
    period: Period,
    /// Rows that came within half a period of the one before: the step behind them is longer by as much, and nothing is lost in it.
    early: u64,
    lags: Lags,
    counts: Counts,
    /// Damaged messages since the last row, each of which takes a number if nothing else counts them.
    damaged: u64,
    /// Largest uncertainty of a time of arrival that was used, ns.
    arrival_spread_ns: i64,
}

/// The last row that was placed.
#[derive(Debug, Clone, Copy)]
struct Last {
    time_ns: i64,
    arrival_ns: i64,
    sequence: u64,
    device_s: Option<f64>,
    number: Option<u64>,
}

/// A step from the last row.
enum Step {
    /// By the device's clock, ns.
    By(i64),
    Repeated,
    Backward(i64),
    Jump,
    /// The device's clock stands still.
    Stopped,
}

impl Timeline {
    /// A timeline without a row. `wrap_s`: range after which the device's clock begins anew.
    #[must_use]
    pub fn new(numbering: Numbering, wrap_s: Option<f64>) -> Self {
        Self {
            numbering,
            wrap_s,
            last: None,
            late_in_a_row: 0,
            tick_ns: 0,
            still_rows: 0,
            is_stopped: false,
            period: Period::default(),
            early: 0,
            lags: Lags::default(),
            counts: Counts::default(),
            damaged: 0,
            arrival_spread_ns: 0,
        }
    }

    /// Counts a damaged message in the place of a row.
    pub fn damaged(&mut self) {
        self.counts.damaged += 1;
        self.damaged += 1;
    }

    /// What was counted so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// The device's clock against the host's, once there are two seconds of rows.
    #[must_use]
    pub fn clock_map(&self) -> Option<ClockMap> {
        self.lags.map()
    }

    /// Largest spread of times of arrival from which a row took its time, s. 0 for devices with a clock.
    #[must_use]
    pub fn arrival_spread_s(&self) -> f64 {
        self.arrival_spread_ns as f64 * 1e-9
    }

    /// How lost rows are noticed, in words that follow "lost samples are counted".
    #[must_use]
    pub fn counted_by(&self) -> String {
        match (self.numbering, self.period.even_ns()) {
            (Numbering::Numbered(_), _) => "by the device's numbers".into(),
            (Numbering::Clock, Some(ns)) => {
                format!("by the device's clock, which ticks every {:.6} s", ns as f64 * 1e-9)
            }
            (Numbering::Clock, None) => {
                "where they are damaged only: the device's clock does not tick evenly and its rows have no number".into()
            }
            (Numbering::Arrival, _) => {
                "where they are damaged only: the device states neither time nor number".into()
            }
        }
    }

    /// Time and number of a row.
    pub fn place(&mut self, row: &Row) -> Placed {
        let Some(last) = self.last else {
            self.tick_ns = row.arrival_ns;
            self.lags.restart(row.device_s, row.arrival_ns);
            return self.keep(row, 0, 0, false);
        };
        let step = self.step(row, last);
        if !matches!(step, Step::Backward(_)) {
            self.late_in_a_row = 0;
        }
        if row.device_s != last.device_s {
            (self.tick_ns, self.still_rows, self.is_stopped) = (row.arrival_ns, 0, false);
        } else if row.arrival_ns.saturating_sub(self.tick_ns) > TICK_NS {
            self.still_rows = self.still_rows.saturating_add(1);
        }
        match step {
            Step::Repeated => {
                self.counts.repeated += 1;
                Placed::Repeated
            }
            Step::Backward(by_ns) if by_ns < OVERTAKEN_NS && self.late_in_a_row < LATE_ROWS => {
                self.late_in_a_row += 1;
                self.counts.late += 1;
                Placed::Late
            }
            Step::By(step_ns) => {
                if row.device_s.is_none() {
                    self.arrival_spread_ns = self.arrival_spread_ns.max(row.spread_ns);
                }
                let passed = self.passed(row, last, step_ns);
                self.keep(
                    row,
                    last.time_ns.saturating_add(step_ns),
                    last.sequence.saturating_add(passed),
                    false,
                )
            }
            Step::Backward(_) | Step::Jump | Step::Stopped => {
                self.late_in_a_row = 0;
                // A clock that stands still is one jump, however many rows come meanwhile.
                let is_new = !matches!(step, Step::Stopped) || !std::mem::replace(&mut self.is_stopped, true);
                self.counts.jumps += u64::from(is_new);
                let host_ns = row.arrival_ns.saturating_sub(last.arrival_ns).max(1);
                self.lags.restart(row.device_s, row.arrival_ns);
                let lost = self.period.even_ns().map_or(0, |period| (host_ns / period - 1).max(0) as u64);
                let time_ns = last.time_ns.saturating_add(host_ns);
                self.keep(row, time_ns, last.sequence.saturating_add(1).saturating_add(lost), is_new)
            }
        }
    }

    fn step(&mut self, row: &Row, last: Last) -> Step {
        let host_ns = row.arrival_ns.saturating_sub(last.arrival_ns).max(0);
        let (Some(now_s), Some(before_s)) = (row.device_s, last.device_s) else {
            return match self.numbers(row, last) {
                Some(0) => Step::Repeated,
                None if row.number.is_some() && last.number.is_some() => Step::Backward(0),
                // Rows of one read arrive at the same time; they keep their order.
                Some(1..) | None => Step::By(host_ns.max(1000)),
            };
        };
        let mut step_s = now_s - before_s;
        if let Some(wrap_s) = self.wrap_s
            && step_s < -0.5 * wrap_s
        {
            step_s += wrap_s;
        }
        if !step_s.is_finite() || step_s.abs() > 1e9 {
            return Step::Jump;
        }
        let step_ns = (step_s * 1e9).round() as i64;
        match step_ns {
            0 if self.numbers(row, last).is_none_or(|passed| passed == 0) => Step::Repeated,
            0 if self.still_rows >= LATE_ROWS => Step::Stopped,
            // A clock coarser than the sampling: the rows share its tick.
            0 => Step::By(1000),
            ..0 => Step::Backward(-step_ns),
            _ if self.lags.ahead_ns(step_ns, row.arrival_ns) > AHEAD_NS => Step::Jump,
            _ => {
                self.lags.take(step_ns, row.arrival_ns);
                Step::By(step_ns)
            }
        }
    }

    /// Steps of the device's number from the last row; `None` without numbers, and where they went back or jumped.
    fn numbers(&self, row: &Row, last: Last) -> Option<u64> {
        let (now, before) = (row.number?, last.number?);
        let wrap = if let Numbering::Numbered(wrap) = self.numbering { wrap } else { 0 };
        let passed = now
            .checked_sub(before)
            .or_else(|| (wrap > 0).then(|| now.saturating_add(wrap).checked_sub(before)).flatten());
        passed.filter(|passed| *passed <= MOST_LOST)
    }

    /// How many numbers a row is behind the last one.
    fn passed(&mut self, row: &Row, last: Last, step_ns: i64) -> u64 {
        let damaged = std::mem::take(&mut self.damaged);
        match self.numbering {
            Numbering::Numbered(_) => match self.numbers(row, last) {
                Some(passed) => passed.max(1),
                None => {
                    self.counts.jumps += 1;
                    1
                }
            },
            Numbering::Clock => {
                self.period.take(step_ns);
                match self.period.even_ns() {
                    Some(period_ns) => self.periods(step_ns, period_ns),
                    None => 1 + damaged,
                }
            }
            Numbering::Arrival => 1 + damaged,
        }
    }

    /// Steps of an even clock in a step, as far as earlier rows have not taken them.
    fn periods(&mut self, step_ns: i64, period_ns: i64) -> u64 {
        let passed = ((step_ns + period_ns / 2) / period_ns) as u64;
        if passed == 0 {
            self.early += 1;
            return 1;
        }
        (passed - std::mem::take(&mut self.early).min(passed - 1)).max(1)
    }

    fn keep(&mut self, row: &Row, time_ns: i64, sequence: u64, jumped: bool) -> Placed {
        self.damaged = 0;
        self.last = Some(Last {
            time_ns,
            arrival_ns: row.arrival_ns,
            sequence,
            device_s: row.device_s,
            number: row.number,
        });
        Placed::At { time_ns, sequence, jumped }
    }
}

#[cfg(test)]
mod tests;
