//! The sequential test: a generalised likelihood ratio over the time of the change.
//!
//! Page's CUSUM (Biometrika 41, 1954) requires a known size of the change. Here the likelihood ratio is maximised over the size and the
//! time (G. Lorden, Ann. Math. Stat. 42, 1971; M. Basseville and I. Nikiforov, Detection of Abrupt Changes, 1993, section 2.4.3). The
//! threshold follows from the mean time between false alarms by the approximation of D. Siegmund and E. Venkatraman, Ann. Stat. 23, 1995.

use std::collections::VecDeque;

use crate::null::Null;

/// Longest window over which a change is sought, blocks. It bounds memory and makes false alarms rarer than the threshold assumes.
const LONGEST: usize = 240;
/// Blocks over which a mean must be back at the baseline's for an alarm to end, and its largest deviation there.
const RETURN_BLOCKS: usize = 6;
const RETURN_DEVIATION: f64 = 3.0;

/// Integral of x nu(x)^2 from 0 to infinity, nu(x) = exp(-0.583 x): the overshoot in the approximation of Siegmund and Venkatraman.
const OVERSHOOT: f64 = 0.735;

/// Threshold of the largest standardised mean of a window for a mean time between false alarms of `blocks`, two-sided.
pub(crate) fn threshold(blocks: f64) -> f64 {
    let run_length =
        |a: f64| (2.0 * std::f64::consts::PI).sqrt() * (a * a / 2.0).exp() / (2.0 * OVERSHOOT * a);
    let (mut low, mut high) = (1.0, 12.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if run_length(middle) < blocks { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The largest standardised mean of the latest blocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Largest {
    /// Size of the standardised mean, 1.
    pub(crate) size: f64,
    /// Number of blocks since the change.
    pub(crate) blocks: usize,
    /// Mean of their deviations, in standard deviations of a block.
    pub(crate) mean: f64,
}

/// The test of one statistic.
#[derive(Debug, Clone)]
pub(crate) struct SequentialTest {
    null: Null,
    /// Deviations of the latest blocks, the newest first.
    deviations: VecDeque<f64>,
}

impl SequentialTest {
    pub(crate) fn new(null: Null) -> Self {
        Self { null, deviations: VecDeque::new() }
    }

    /// Takes the value of a block; NaN is ignored.
    pub(crate) fn push(&mut self, value: f64) {
        // A block without a value counts as a usual one, so that all statistics have the same number of blocks.
        let deviation = if value.is_finite() { self.null.deviation(value) } else { 0.0 };
        self.deviations.push_front(deviation);
        self.deviations.truncate(LONGEST);
    }

    /// The test over all times of a change.
    pub(crate) fn largest(&self) -> Largest {
        let mut largest = Largest { size: 0.0, blocks: 0, mean: 0.0 };
        let mut sum = 0.0;
        for (blocks, deviation) in (1..).zip(&self.deviations) {
            sum += deviation;
            let mean = sum / blocks as f64;
            let size = mean.abs() / self.null.std_of_mean(blocks as f64);
            if size > largest.size {
                largest = Largest { size, blocks, mean };
            }
        }
        largest
    }

    /// Whether the latest blocks are as usual.
    pub(crate) fn has_returned(&self) -> bool {
        let blocks = RETURN_BLOCKS as f64;
        let mean = self.deviations.iter().take(RETURN_BLOCKS).sum::<f64>() / blocks;
        self.deviations.len() >= RETURN_BLOCKS
            && mean.abs() < RETURN_DEVIATION * self.null.std_of_mean(blocks)
    }

    /// Drops all deviations.
    pub(crate) fn clear(&mut self) {
        self.deviations.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Normal(u64);

    impl Normal {
        /// Sum of twelve uniform numbers.
        fn next(&mut self) -> f64 {
            let mut uniform = || {
                self.0 =
                    self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        }
    }

    fn test(random: &mut Normal) -> SequentialTest {
        let healthy: Vec<f64> = (0..2000).map(|_| random.next()).collect();
        SequentialTest::new(Null::of(&healthy).unwrap())
    }

    #[test]
    fn false_alarms_are_no_more_frequent_than_stated() {
        let mut random = Normal(3);
        let (every, blocks) = (1000.0, 60_000);
        let mut watch = test(&mut random);
        let limit = threshold(every);
        let mut alarms = 0;
        for _ in 0..blocks {
            watch.push(random.next());
            if watch.largest().size > limit {
                alarms += 1;
                watch.clear();
            }
        }
        // The stated rate gives 60 alarms. The threshold is conservative by a factor of six at most.
        assert!((10..75).contains(&alarms), "{alarms}");
    }

    #[test]
    fn a_change_is_found_with_its_time_and_size() {
        let mut random = Normal(5);
        let mut watch = test(&mut random);
        (0..200).for_each(|_| watch.push(random.next()));
        assert!(watch.largest().size < threshold(1e5));
        let mut delay = 0;
        while watch.largest().size < threshold(1e5) {
            watch.push(1.5 + random.next());
            delay += 1;
        }
        let found = watch.largest();
        assert!((4..40).contains(&delay), "{delay}");
        assert!(found.blocks.abs_diff(delay) <= 4, "{found:?} {delay}");
        assert!((found.mean - 1.5).abs() < 0.7, "{found:?}");
        assert!(!watch.has_returned());
        (0..20).for_each(|_| watch.push(random.next()));
        assert!(watch.has_returned());
    }

    #[test]
    fn one_block_alone_raises_no_alarm() {
        let mut watch = test(&mut Normal(1));
        watch.push(1e9);
        assert!(watch.largest().size < threshold(1e4), "{:?}", watch.largest());
    }
}
