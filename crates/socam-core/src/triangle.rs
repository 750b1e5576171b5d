//! The triangular mean over the conversions of two sampling intervals: weights 1, 2, 3, 4, 3, 2, 1, 0 with four conversions per interval.
//!
//! Sums of sums have these weights, so that a conversion is added without a multiplication.

/// Counts the conversions of a sampling interval.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval {
    log2: u32,
    taken: u32,
}

impl Interval {
    /// An interval of two to the power of `log2` conversions, of which none is taken.
    pub(crate) fn new(log2: u32) -> Self {
        Self { log2, taken: 0 }
    }

    /// Number of the next conversion within the interval, from 0.
    pub(crate) fn position(&self) -> u32 {
        self.taken
    }

    /// Takes a conversion; where it completes the interval, returns `log2` for [`Triangle::complete`].
    pub(crate) fn step(&mut self) -> Option<u32> {
        self.taken = self.taken.wrapping_add(1);
        if self.taken < 1u32.wrapping_shl(self.log2) {
            return None;
        }
        self.taken = 0;
        Some(self.log2)
    }
}

/// The running sums of one quantity. The first mean lacks its earlier half.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Triangle {
    /// All conversions of the interval.
    sum: i64,
    /// The sums after each of its conversions: the first conversion is in all of them, the last one in one.
    sums: i64,
    /// What the interval before adds to the next mean.
    before: i64,
}

impl Triangle {
    /// Adds a conversion.
    pub(crate) fn push(&mut self, value: i64) {
        self.sum = self.sum.wrapping_add(value);
        self.sums = self.sums.wrapping_add(self.sum);
    }

    /// The mean, after the last conversion of an interval of two to the power of `log2` (1 to 15) conversions; its lower 32 bits.
    pub(crate) fn complete(&mut self, log2: u32) -> i32 {
        // The last conversion weighs nothing here, and the most in the next mean.
        self.finish(self.sums.wrapping_sub(self.sum), log2, log2.wrapping_mul(2))
    }

    /// The mean of values of which each is itself a mean since the conversion before, and so belongs to the middle of that time: weights 1,
    /// 3, 5, 7, 7, 5, 3, 1 are those of the triangle half a step earlier.
    pub(crate) fn complete_between(&mut self, log2: u32) -> i32 {
        let falling = self.sums.wrapping_mul(2).wrapping_sub(self.sum);
        self.finish(falling, log2.wrapping_add(1), log2.wrapping_mul(2).wrapping_add(1))
    }

    /// `falling`: the interval's part of the mean. Two to the power of `both`: weight of each conversion in this mean and the next one
    /// together; of `all`: weight of all conversions in a mean.
    fn finish(&mut self, falling: i64, both: u32, all: u32) -> i32 {
        let rounded = self.before.wrapping_add(falling).wrapping_add(1i64.wrapping_shl(all) >> 1);
        self.before = shifted_up(self.sum, both).wrapping_sub(falling);
        (self.sum, self.sums) = (0, 0);
        shifted_down(rounded, all)
    }
}

/// `value * 2^by`, for 1 to 31. A shift of 64 bits would be a call for a processor that shifts 32.
fn shifted_up(value: i64, by: u32) -> i64 {
    let (low, high) = (value as u32, (value >> 32) as u32);
    let high = high.wrapping_shl(by) | low.wrapping_shr(32u32.wrapping_sub(by));
    (i64::from(high as i32) << 32) | i64::from(low.wrapping_shl(by))
}

/// The lower half of `value / 2^by`, rounded down, for 1 to 31.
fn shifted_down(value: i64, by: u32) -> i32 {
    let (low, high) = (value as u32, (value >> 32) as u32);
    (low.wrapping_shr(by) | high.wrapping_shl(32u32.wrapping_sub(by))) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Means of a stream, at four conversions per interval.
    fn means(values: impl Iterator<Item = i64>, complete: fn(&mut Triangle, u32) -> i32) -> Vec<i32> {
        let (mut interval, mut triangle) = (Interval::new(2), Triangle::default());
        let means = values.filter_map(|value| {
            triangle.push(value);
            interval.step().map(|log2| complete(&mut triangle, log2))
        });
        means.collect()
    }

    #[test]
    fn weights_are_those_of_a_triangle_at_conversions_or_between_them() {
        let weights = |unit: i64, complete: fn(&mut Triangle, u32) -> i32| -> Vec<i32> {
            let one = |at: i64| means((0..12).map(|i| if i == at { unit } else { 0 }), complete)[2];
            (4..12).map(one).collect()
        };
        assert_eq!(weights(16, Triangle::complete), [1, 2, 3, 4, 3, 2, 1, 0]);
        assert_eq!(weights(32, Triangle::complete_between), [1, 3, 5, 7, 7, 5, 3, 1]);
    }

    #[test]
    fn a_constant_is_its_own_mean_however_wide_and_a_wide_one_wraps() {
        for value in [i64::from(i32::MIN), -1, 0, i64::from(i32::MAX), (1 << 40) - 3, -(1 << 40) + 3] {
            for complete in [Triangle::complete, Triangle::complete_between] {
                assert_eq!(means(core::iter::repeat_n(value, 12), complete)[1..], [value as i32; 2]);
            }
        }
    }
}
