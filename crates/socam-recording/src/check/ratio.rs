//! The average ratio of two speeds that a gear joins.

use super::finding::Finding;
use super::options::FixedRatio;
use crate::dataset::Block;

/// Length of the averages that are compared, s; it is long compared with oscillations and lags between the two shafts.
const WINDOW_S: f64 = 1.0;

/// Standard errors that a deviation must exceed to be a finding. By chance, one in 370 recordings exceeds three.
const STANDARD_ERRORS: f64 = 3.0;

/// Least-squares slope of the averages of the fast speed over those of the slow speed. For a shaft that turns one way this is the ratio of
/// their means; for one that reverses, the means are near zero and the slope is still determined.
pub(super) struct RatioFit {
    fixed: FixedRatio,
    fast: usize,
    slow: usize,
    window: Window,
    fast_fast: f64,
    fast_slow: f64,
    slow_slow: f64,
    windows: u32,
}

/// Sums over the present window.
#[derive(Default)]
struct Window {
    segment: usize,
    begin_s: f64,
    rows: u32,
    fast: f64,
    slow: f64,
}

impl RatioFit {
    pub(super) fn new(fixed: FixedRatio, fast: usize, slow: usize) -> Self {
        let window = Window::default();
        Self { fixed, fast, slow, window, fast_fast: 0.0, fast_slow: 0.0, slow_slow: 0.0, windows: 0 }
    }

    pub(super) fn take(&mut self, block: &Block) {
        let fast = block.columns[self.fast].values();
        let slow = block.columns[self.slow].values();
        for (time_s, (fast, slow)) in block.time_s.iter().zip(fast.iter().zip(slow)) {
            if fast.is_nan() || slow.is_nan() {
                continue;
            }
            if self.window.rows == 0 || self.window.segment != block.segment {
                self.window = Window { segment: block.segment, begin_s: *time_s, ..Window::default() };
            }
            self.window.rows += 1;
            self.window.fast += self.fixed.fast.si(*fast);
            self.window.slow += self.fixed.slow.si(*slow);
            if *time_s - self.window.begin_s >= WINDOW_S {
                self.close();
            }
        }
    }

    fn close(&mut self) {
        let Window { rows, fast, slow, .. } = std::mem::take(&mut self.window);
        let (fast, slow) = (fast / f64::from(rows), slow / f64::from(rows));
        self.fast_fast += fast * fast;
        self.fast_slow += fast * slow;
        self.slow_slow += slow * slow;
        self.windows += 1;
    }

    /// A finding if the ratio deviates; `None` also with fewer than two windows.
    pub(super) fn finish(self) -> Option<Finding> {
        let measured = self.fast_slow / self.slow_slow;
        let deviation = measured / self.fixed.ratio - 1.0;
        let scatter =
            (self.fast_fast - measured * self.fast_slow).max(0.0) / f64::from(self.windows.max(2) - 1);
        let standard_error = (scatter / self.slow_slow).sqrt() / self.fixed.ratio.abs();
        let broken = self.windows >= 2
            && measured.is_finite()
            && deviation.abs() > self.fixed.tolerance.max(STANDARD_ERRORS * standard_error);
        broken.then_some(Finding::RatioBroken {
            fast: self.fixed.fast.channel,
            slow: self.fixed.slow.channel,
            expected: self.fixed.ratio,
            measured,
            deviation_percent: 100.0 * deviation,
        })
    }
}
