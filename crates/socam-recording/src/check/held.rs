//! Where channels are clipped or stuck: the rows of the flat parts that [`flat`](super::flat) finds.

use std::ops::Range;

use super::flat::{Flat, FlatParts, SHORTEST_STUCK};
use crate::{Dataset, error::Result};

/// Where a channel is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HeldAt {
    /// At its least value: clipped.
    Least,
    /// At its greatest value: clipped.
    Greatest,
    /// At a value between: stuck.
    Between,
}

/// A value at which a channel was held, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// Index of the channel.
    pub channel: usize,
    /// The value, in the channel's unit.
    pub value: f64,
    /// Whether the channel is clipped there, at which end, or stuck.
    pub at: HeldAt,
    /// The rows at which it reads that value (give or take one step of its resolution, where it does so in runs).
    pub rows: Vec<Range<u64>>,
    /// How many rows that are, as a share of all rows.
    pub share: f64,
}

/// Finds where channels (by index), inputs and outputs alike, are clipped or stuck, as [`check`](super::check()) tells it. A channel
/// that rests, at an end of its travel too, turns round, or moves by few steps of its resolution is neither.
///
/// # Errors
/// When the file cannot be read again.
pub fn held(data: &Dataset, channels: &[usize]) -> Result<Vec<Held>> {
    let all = channels.iter().map(|channel| FlatParts::of(data, *channel));
    let mut all: Vec<FlatParts> = all.collect();
    for block in data.blocks_in(0..data.rows(), channels)? {
        for (parts, column) in all.iter_mut().zip(&block?.columns) {
            column.values().iter().filter(|value| !value.is_nan()).for_each(|value| parts.push(*value));
        }
    }
    let mut found = Vec::new();
    for (parts, channel) in all.into_iter().zip(channels) {
        for flat in parts.finish() {
            let rows = rows_of(data, *channel, &flat)?;
            let share = rows.iter().map(|r| r.end - r.start).sum::<u64>() as f64 / data.rows().max(1) as f64;
            found.push(Held { channel: *channel, value: flat.value, at: flat.at, rows, share });
        }
    }
    Ok(found)
}

/// A value at which a channel sticks, and where it is held by it.
#[derive(Debug, Clone, PartialEq)]
pub struct Saturation {
    /// Index of the channel.
    pub channel: usize,
    /// The value at which it sticks, in the channel's unit.
    pub limit: f64,
    /// All rows of that value.
    pub rows: Vec<Range<u64>>,
}

/// Where channels (by index) are clipped at an extreme: of what [`held`] finds, all but what is stuck between.
///
/// # Errors
/// When the file cannot be read again.
pub fn saturations(data: &Dataset, channels: &[usize]) -> Result<Vec<Saturation>> {
    let clipped = held(data, channels)?.into_iter().filter(|held| held.at != HeldAt::Between);
    Ok(clipped.map(|held| Saturation { channel: held.channel, limit: held.value, rows: held.rows }).collect())
}

/// The rows at which a channel is within the tolerance of a value; between the extremes only in runs, since it passes there too.
fn rows_of(data: &Dataset, channel: usize, flat: &Flat) -> Result<Vec<Range<u64>>> {
    let mut found: Vec<Range<u64>> = Vec::new();
    for block in data.blocks_in(0..data.rows(), &[channel])? {
        let block = block?;
        let values = block.columns[0].values().iter().zip(block.first_row..);
        for (_, row) in values.filter(|(own, _)| (**own - flat.value).abs() <= flat.tolerance) {
            match found.last_mut() {
                Some(last) if last.end == row => last.end += 1,
                _ => found.push(row..row + 1),
            }
        }
    }
    if flat.at == HeldAt::Between {
        found.retain(|rows| rows.end - rows.start >= SHORTEST_STUCK);
    }
    Ok(found)
}
