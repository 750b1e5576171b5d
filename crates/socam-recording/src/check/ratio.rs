//! Two speeds tied by a gear: their ratio on average.

use super::FixedRatio;
use super::finding::Finding;
use crate::dataset::Block;

/// Least-squares slope of the fast speed over the slow one. Where the shaft turns one way this is the ratio of the means;
/// where it reverses, means vanish and the slope does not.
pub(super) struct RatioFit {
    fixed: FixedRatio,
    fast: usize,
    slow: usize,
    fast_slow: f64,
    slow_slow: f64,
}

impl RatioFit {
    pub(super) fn new(fixed: FixedRatio, fast: usize, slow: usize) -> Self {
        Self { fixed, fast, slow, fast_slow: 0.0, slow_slow: 0.0 }
    }

    pub(super) fn take(&mut self, block: &Block) {
        let fast = block.columns[self.fast].values();
        let slow = block.columns[self.slow].values();
        for (fast, slow) in fast.iter().zip(slow) {
            if !fast.is_nan() && !slow.is_nan() {
                self.fast_slow += fast * slow;
                self.slow_slow += slow * slow;
            }
        }
    }

    pub(super) fn finish(self) -> Option<Finding> {
        let measured = self.fast_slow / self.slow_slow;
        let deviation = measured / self.fixed.ratio - 1.0;
        let broken = measured.is_finite() && deviation.abs() > self.fixed.tolerance;
        broken.then_some(Finding::RatioBroken {
            fast: self.fixed.fast,
            slow: self.fixed.slow,
            expected: self.fixed.ratio,
            measured,
            deviation_percent: 100.0 * deviation,
        })
    }
}
