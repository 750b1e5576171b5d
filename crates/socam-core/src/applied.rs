//! The voltage that a bridge applies, as a channel.
//!
//! Other channels are read at conversions. This one is a mean since the conversion before, so it belongs to the middle of that time, and
//! its mean is the triangle of [`crate::Average`] half a step earlier.

use crate::triangle::{Interval, Triangle};

/// The running mean.
#[derive(Debug, Clone, Copy)]
pub struct Applied {
    interval: Interval,
    triangle: Triangle,
    mean: i32,
}

impl Applied {
    /// Two to the power of `log2` (1 to 15) conversions in a sampling interval, without any.
    pub fn new(log2: u32) -> Self {
        Self { interval: Interval::new(log2), triangle: Triangle::default(), mean: 0 }
    }

    /// Adds the mean voltage since the last conversion, in counts of 16 bits.
    pub fn push(&mut self, count: i32) {
        self.triangle.push(count.into());
        if let Some(log2) = self.interval.step() {
            self.mean = self.triangle.complete_between(log2);
        }
    }

    /// The latest sample.
    pub fn sample(&self) -> i32 {
        self.mean
    }
}
