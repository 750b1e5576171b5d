//! The rows at which channels are clipped or stuck, for the flat parts that [`flat`](super::flat) finds.

use std::ops::Range;

use super::finding::HeldAt;
use super::flat::FlatParts;
use super::runs::{Flat, SHORTEST_STUCK};
use crate::{Dataset, error::Result};

/// A value at which a channel is held, and its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// Index of the channel.
    pub channel: usize,
    /// The value, in the channel's unit.
    pub value: f64,
    /// Whether the channel is clipped there, at which end, or stuck.
    pub at: HeldAt,
    /// The rows at which it reads that value (within one step of its resolution, if it was found so).
    pub rows: Vec<Range<u64>>,
    /// Share of all rows.
    pub share: f64,
}

/// Finds where channels (by index) are clipped or stuck, by the rules of [`check`](super::check()). A channel that is at rest (also
/// at an end of its travel), reverses, or moves by few steps of its resolution is neither.
///
/// ```
/// use socam_recording::check::{HeldAt, held};
///
/// # use socam_recording::{Channel, Dataset, Unit};
/// # let time_s: Vec<f64> = (0..2000).map(|k| 1e-3 * f64::from(k)).collect();
/// # let noise = |t: f64| 0.02 * (1.7e6 * t * t).sin();
/// // A noisy sine of amplitude 1 that is limited to 0.8.
/// let clipped = time_s.iter().map(|t| ((std::f64::consts::TAU * 2.0 * t).sin() + noise(*t)).clamp(-0.8, 0.8)).collect();
/// let data = Dataset::from_columns("run", vec![Channel::new("torque", Unit::Nm)], time_s, vec![clipped])?;
/// let found = held(&data, &[0])?;
/// assert_eq!(found.len(), 2);
/// assert!(found.iter().any(|held| held.at == HeldAt::Greatest && held.value == 0.8));
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
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

/// A limit at which a channel is clipped, and its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Saturation {
    /// Index of the channel.
    pub channel: usize,
    /// The limit, in the channel's unit.
    pub limit: f64,
    /// All rows at the limit.
    pub rows: Vec<Range<u64>>,
}

/// Where channels (by index) are clipped at an extreme: what [`held`] finds, without [`HeldAt::Between`].
///
/// ```
/// use socam_recording::check::saturations;
///
/// # use socam_recording::{Channel, Dataset, Unit};
/// # let time_s: Vec<f64> = (0..2000).map(|k| 1e-3 * f64::from(k)).collect();
/// # let noise = |t: f64| 0.02 * (1.7e6 * t * t).sin();
/// // A noisy sine of amplitude 1 that is limited to 0.8.
/// let clipped = time_s.iter().map(|t| ((std::f64::consts::TAU * 2.0 * t).sin() + noise(*t)).clamp(-0.8, 0.8)).collect();
/// let data = Dataset::from_columns("run", vec![Channel::new("torque", Unit::Nm)], time_s, vec![clipped])?;
/// let mut limits: Vec<f64> = saturations(&data, &[0])?.iter().map(|found| found.limit).collect();
/// limits.sort_by(f64::total_cmp);
/// assert_eq!(limits, [-0.8, 0.8]);
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
///
/// # Errors
/// When the file cannot be read again.
pub fn saturations(data: &Dataset, channels: &[usize]) -> Result<Vec<Saturation>> {
    let clipped = held(data, channels)?.into_iter().filter(|held| held.at != HeldAt::Between);
    Ok(clipped.map(|held| Saturation { channel: held.channel, limit: held.value, rows: held.rows }).collect())
}

/// The rows at which a channel is within the tolerance of a value. Between the extremes only long runs count: the channel also passes
/// through that value.
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
