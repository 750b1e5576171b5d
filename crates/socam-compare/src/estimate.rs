//! Numbers with their uncertainty.

use serde::Serialize;

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its interval.
    pub ci95: [f64; 2],
}

impl Estimate {
    pub(crate) fn new(value: f64, half_width: f64) -> Self {
        Self { value, ci95: [value - half_width, value + half_width] }
    }

    /// Whether the interval leaves out a value.
    #[must_use]
    pub fn excludes(&self, value: f64) -> bool {
        value < self.ci95[0] || value > self.ci95[1]
    }
}
