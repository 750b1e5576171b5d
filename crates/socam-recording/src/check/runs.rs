//! Saturation: runs of one identical value at a channel's extreme, unlike runs elsewhere.

use super::finding::Finding;
use crate::Channel;

/// Shortest run at an extreme that counts.
const SHORTEST_RUN: u64 = 8;

/// How much longer such a run is than any elsewhere. A staircase rests on every step and is no saturation.
const LONGER_THAN_ELSEWHERE: u64 = 4;

/// Share of rows away from the extremes below which the signal just switches between two values.
const SWITCHING: f64 = 0.2;

/// Mean length of such runs, as a share of all rows, above which the signal rests there rather than being cut off.
const RESTING: f64 = 0.05;

/// Runs of identical values, at each extreme and elsewhere.
pub(super) struct ExtremeRuns {
    extremes: [Extreme; 2],
    value: f64,
    run: u64,
    rows: u64,
    longest_elsewhere: u64,
}

struct Extreme {
    value: f64,
    /// Rows in runs that count.
    rows: u64,
    runs: u64,
    longest: u64,
    all_rows: u64,
}

impl ExtremeRuns {
    pub(super) fn new(min: f64, max: f64) -> Self {
        let extreme = |value| Extreme { value, rows: 0, runs: 0, longest: 0, all_rows: 0 };
        Self {
            extremes: [extreme(min), extreme(max)],
            value: f64::NAN,
            run: 0,
            rows: 0,
            longest_elsewhere: 0,
        }
    }

    pub(super) fn push(&mut self, value: f64) {
        if value == self.value {
            self.run += 1;
        } else {
            self.close(false);
            self.value = value;
            self.run = 1;
        }
        self.rows += 1;
    }

    /// A run that touches the recording's start or end is a bench at rest as often as a saturated sensor: only its rows count.
    fn close(&mut self, at_end: bool) {
        let at_edge = at_end || self.run == self.rows;
        let extreme = self.extremes.iter_mut().find(|extreme| extreme.value == self.value);
        match extreme {
            Some(extreme) => {
                extreme.all_rows += self.run;
                if !at_edge && self.run >= SHORTEST_RUN && extreme.value != 0.0 {
                    extreme.rows += self.run;
                    extreme.runs += 1;
                    extreme.longest = extreme.longest.max(self.run);
                }
            }
            None => self.longest_elsewhere = self.longest_elsewhere.max(self.run),
        }
    }

    pub(super) fn finish(mut self, channel: &Channel) -> Vec<Finding> {
        self.close(true);
        let at_extremes: u64 = self.extremes.iter().map(|e| e.all_rows).sum();
        let elsewhere = (self.rows - at_extremes) as f64 / self.rows as f64;
        if elsewhere < SWITCHING {
            return Vec::new();
        }
        self.extremes
            .iter()
            .filter(|extreme| extreme.longest >= LONGER_THAN_ELSEWHERE * self.longest_elsewhere.max(1))
            .filter(|extreme| extreme.rows > 0)
            .filter(|extreme| extreme.rows as f64 <= RESTING * (self.rows * extreme.runs) as f64)
            .map(|extreme| Finding::Saturated {
                channel: channel.name.clone(),
                unit: channel.unit,
                limit: extreme.value,
                rows: extreme.rows,
                longest_run_rows: extreme.longest,
            })
            .collect()
    }
}
