//! The voltage that the bridge applies, as a channel.
//!
//! Other channels are read at conversions. This one is a mean since the conversion before, so it belongs to the middle of that time:
//! under the sample's triangle (`socam_core::Average`) its weights are those half a step earlier, 1, 3, 5, 7, 7, 5, 3, 1.

/// The running sums.
pub(crate) struct Applied {
    log2: u32,
    taken: i32,
    rising: i32,
    falling: i32,
    before: i32,
    mean: i32,
}

impl Applied {
    /// Two to the power of `log2` conversions in a sampling interval.
    pub(crate) fn new(log2: u32) -> Self {
        Self { log2, taken: 0, rising: 0, falling: 0, before: 0, mean: 0 }
    }

    /// Adds the mean voltage since the last conversion, in counts of 16 bits.
    pub(crate) fn push(&mut self, count: i32) {
        let whole = 2i32.wrapping_shl(self.log2);
        let up = self.taken.wrapping_mul(2).wrapping_add(1);
        self.taken = self.taken.wrapping_add(1);
        // At most 32 conversions: 32768 times 2 times 32 squared.
        self.rising = self.rising.wrapping_add(count.wrapping_mul(up));
        self.falling = self.falling.wrapping_add(count.wrapping_mul(whole.wrapping_sub(up)));
        if self.taken.wrapping_mul(2) < whole {
            return;
        }
        let shift = self.log2.wrapping_mul(2).wrapping_add(1);
        let half = 1i32.wrapping_shl(shift) >> 1;
        self.mean = self.before.wrapping_add(self.falling).wrapping_add(half).wrapping_shr(shift);
        (self.before, self.rising, self.falling, self.taken) = (self.rising, 0, 0, 0);
    }

    /// The latest sample.
    pub(crate) fn sample(&self) -> i32 {
        self.mean
    }
}
