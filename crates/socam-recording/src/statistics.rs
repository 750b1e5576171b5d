//! Least, greatest, mean and standard deviation of a channel, in one pass.

use serde::Serialize;

/// Statistics of one channel over its present values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statistics {
    /// Number of values.
    pub count: u64,
    /// Number of rows without a value.
    pub missing: u64,
    /// Smallest value, in the channel's unit; `None` when no value is present.
    pub min: Option<f64>,
    /// Largest value, in the channel's unit.
    pub max: Option<f64>,
    /// Mean, in the channel's unit.
    pub mean: Option<f64>,
    /// Standard deviation (of the values, dividing by count - 1), in the channel's unit; `None` below two values.
    pub std: Option<f64>,
}

/// Moments of blocks, combined by Chan's formula: no cancellation when the mean is large.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Running {
    count: u64,
    missing: u64,
    min: f64,
    max: f64,
    mean: f64,
    squares: f64,
}

impl Running {
    pub(crate) const fn new() -> Self {
        Self { count: 0, missing: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, mean: 0.0, squares: 0.0 }
    }

    /// Appends values; NaN counts as missing.
    pub(crate) fn take(&mut self, values: &[f64]) {
        let present = || values.iter().copied().filter(|value| !value.is_nan());
        let Some(near) = present().next() else {
            self.missing += values.len() as u64;
            return;
        };
        let (mut count, mut sum) = (0, 0.0);
        for value in present() {
            count += 1;
            sum += value - near;
            self.min = self.min.min(value);
            self.max = self.max.max(value);
        }
        self.missing += values.len() as u64 - count;
        let mean = near + sum / count as f64;
        let squares: f64 = present().map(|value| (value - mean) * (value - mean)).sum();
        let (own, theirs) = (self.count as f64, count as f64);
        let delta = mean - self.mean;
        self.mean += delta * theirs / (own + theirs);
        self.squares += squares + delta * delta * own * theirs / (own + theirs);
        self.count += count;
    }

    pub(crate) fn finish(self) -> Statistics {
        let present = |value: f64| (self.count > 0).then_some(value);
        Statistics {
            count: self.count,
            missing: self.missing,
            min: present(self.min),
            max: present(self.max),
            mean: present(self.mean),
            std: (self.count > 1).then(|| (self.squares / (self.count - 1) as f64).sqrt()),
        }
    }
}
