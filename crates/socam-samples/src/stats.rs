//! Statistics of a range of a channel, computed from its samples and not from the drawn curve.

use super::stored::Samples;

/// Statistics of the values in a range of time, in the channel's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stats {
    /// Number of values that are not missing.
    pub count: u64,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Mean.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Standard deviation of these values: `rms² = mean² + std²`.
    pub std: f64,
}

impl Stats {
    /// Greatest minus least value.
    #[must_use]
    pub fn peak_to_peak(&self) -> f64 {
        self.max - self.min
    }
}

/// Statistics of a channel from one time to another, s, both included; `None` without a value. The cost does not depend on the number
/// of samples: all but the ends of the range comes from sums of blocks.
#[must_use]
pub fn stats(samples: &Samples, channel: usize, [from_s, to_s]: [f64; 2]) -> Option<Stats> {
    let rows = samples.row_at(from_s)..samples.row_at(to_s.next_up());
    if rows.start >= rows.end {
        return None;
    }
    let [min, max] = samples.extremes(channel, rows.clone())?;
    let moments = samples.moments(channel, rows);
    let variance = moments.squares / moments.count;
    Some(Stats {
        count: moments.count as u64,
        min,
        max,
        mean: moments.mean,
        rms: (moments.mean * moments.mean + variance).sqrt(),
        std: variance.sqrt(),
    })
}

#[cfg(test)]
mod tests;
