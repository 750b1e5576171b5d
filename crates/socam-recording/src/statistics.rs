//! Smallest, largest, mean and spread of a channel, in one pass.

use serde::Serialize;

/// What one channel holds, over all its present values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statistics {
    /// Values present.
    pub count: u64,
    /// Rows without a value of this channel.
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

/// Welford's running moments: no cancellation when the mean is large.
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

    /// Takes a value; NaN counts as missing.
    pub(crate) fn push(&mut self, value: f64) {
        if value.is_nan() {
            self.missing += 1;
            return;
        }
        self.count += 1;
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        let delta = value - self.mean;
        self.mean += delta / self.count as f64;
        self.squares += delta * (value - self.mean);
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
