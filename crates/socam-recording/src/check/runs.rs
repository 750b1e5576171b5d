//! Saturation: runs of one identical value at a channel's extreme, unlike runs elsewhere.

use std::ops::Range;

use super::finding::Finding;
use crate::{Channel, Dataset, error::Result};

/// Shortest run at an extreme that counts.
const SHORTEST_RUN: u64 = 8;

/// How much longer such a run is than any elsewhere. A staircase rests on every step and is no saturation.
const LONGER_THAN_ELSEWHERE: u64 = 4;

/// Share of rows away from the extremes below which the signal just switches between two values.
const SWITCHING: f64 = 0.2;

/// Mean length of such runs, as a share of all rows, above which the signal rests there rather than being cut off; a noisy
/// signal never rests at one value.
const RESTING: f64 = 0.05;

/// A channel is noisy when its fourth differences change sign so often elsewhere (white noise: four times out of five, a motion
/// twice per period), and are so large beside the channel's range.
const ALTERNATING: f64 = 0.4;
const LEAST_NOISE: f64 = 1e-4;

/// Values that a channel cannot exceed, and where it is held by them.
#[derive(Debug, Clone, PartialEq)]
pub struct Saturation {
    /// Index of the channel.
    pub channel: usize,
    /// The value at which it sticks, in the channel's unit.
    pub limit: f64,
    /// All rows of that value.
    pub rows: Vec<Range<u64>>,
}

/// Finds where channels (by index) are saturated, as [`check`](super::check()) tells it.
///
/// # Errors
/// When the file cannot be read again.
pub fn saturations(data: &Dataset, channels: &[usize]) -> Result<Vec<Saturation>> {
    let extremes = channels.iter().map(|channel| {
        let statistics = &data.statistics()[*channel];
        ExtremeRuns::new(statistics.min.unwrap_or(0.0), statistics.max.unwrap_or(0.0))
    });
    let mut runs: Vec<ExtremeRuns> = extremes.collect();
    for block in data.blocks_in(0..data.rows(), channels)? {
        for (runs, column) in runs.iter_mut().zip(&block?.columns) {
            column.values().iter().filter(|value| !value.is_nan()).for_each(|value| runs.push(*value));
        }
    }
    let mut found = Vec::new();
    for (runs, channel) in runs.into_iter().zip(channels) {
        for extreme in runs.saturated() {
            let rows = rows_of(data, *channel, extreme.value)?;
            found.push(Saturation { channel: *channel, limit: extreme.value, rows });
        }
    }
    Ok(found)
}

/// The rows at which a channel has exactly this value.
fn rows_of(data: &Dataset, channel: usize, value: f64) -> Result<Vec<Range<u64>>> {
    let mut found: Vec<Range<u64>> = Vec::new();
    for block in data.blocks_in(0..data.rows(), &[channel])? {
        let block = block?;
        let values = block.columns[0].values().iter().zip(block.first_row..);
        for (_, row) in values.filter(|(own, _)| **own == value) {
            match found.last_mut() {
                Some(last) if last.end == row => last.end += 1,
                _ => found.push(row..row + 1),
            }
        }
    }
    Ok(found)
}

/// Runs of identical values, at each extreme and elsewhere.
pub(super) struct ExtremeRuns {
    extremes: [Extreme; 2],
    value: f64,
    run: u64,
    rows: u64,
    longest_elsewhere: u64,
    noise: Noise,
}

/// How the fourth differences of a channel move.
#[derive(Default)]
struct Noise {
    /// The last value and its differences of first to third order.
    last: [f64; 4],
    fourth: f64,
    alternations: u64,
    size: f64,
}

impl Noise {
    fn push(&mut self, value: f64) {
        let mut difference = value;
        for last in &mut self.last {
            difference -= std::mem::replace(last, difference);
        }
        self.alternations += u64::from(difference * self.fourth < 0.0);
        self.size += difference.abs();
        self.fourth = difference;
    }
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
            noise: Noise::default(),
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
        self.noise.push(value);
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

    pub(super) fn finish(self, channel: &Channel) -> Vec<Finding> {
        let finding = |extreme: Extreme| Finding::Saturated {
            channel: channel.name.clone(),
            unit: channel.unit,
            limit: extreme.value,
            rows: extreme.rows,
            longest_run_rows: extreme.longest,
        };
        self.saturated().into_iter().map(finding).collect()
    }

    /// The extremes at which the channel was cut off.
    fn saturated(mut self) -> Vec<Extreme> {
        self.close(true);
        let at_extremes: u64 = self.extremes.iter().map(|e| e.all_rows).sum();
        let elsewhere = (self.rows - at_extremes) as f64 / self.rows as f64;
        if elsewhere < SWITCHING {
            return Vec::new();
        }
        let noisy = self.noisy(elsewhere * self.rows as f64);
        self.extremes
            .into_iter()
            .filter(|extreme| extreme.longest >= LONGER_THAN_ELSEWHERE * self.longest_elsewhere.max(1))
            .filter(|extreme| extreme.rows > 0)
            .filter(|extreme| noisy || extreme.rows as f64 <= RESTING * (self.rows * extreme.runs) as f64)
            .collect()
    }

    /// Whether values away from the extremes, so many, are noisy.
    fn noisy(&self, elsewhere: f64) -> bool {
        let range = (self.extremes[1].value - self.extremes[0].value).abs();
        self.noise.alternations as f64 > ALTERNATING * elsewhere
            && self.noise.size > LEAST_NOISE * range * elsewhere
    }
}
