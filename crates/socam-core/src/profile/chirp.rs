//! A logarithmic chirp: equal time in every octave.

use super::checks::{check_frequency, whole_samples};
use super::error::{ProfileError, ProfileKey};
use super::target::Target;
use crate::fixed;

/// Fewest samples per sweep: below, the series in [`growth_q64`] loses digits.
const FEWEST_SAMPLES: u32 = 1000;

#[derive(Debug, Clone, Copy)]
pub(super) struct Chirp {
    offset_micro: i32,
    amplitude_micro: i32,
    /// Phase and its increment per sample, in turns of 2^64.
    phase: u64,
    increment: u64,
    first_increment: u64,
    /// Relative growth (or, for a falling chirp, shrinkage) of the increment per sample, in 1/2^64.
    growth_q64: u64,
    falling: bool,
    samples: u32,
    samples_left: u32,
    sweep: u16,
}

impl Chirp {
    pub(super) fn new(
        offset_micro: i32,
        amplitude_micro: i32,
        start_uhz: u32,
        end_uhz: u32,
        sweep_us: u32,
        sample_period_us: u32,
    ) -> Result<Self, ProfileError> {
        check_frequency(u64::from(start_uhz), sample_period_us)?;
        check_frequency(u64::from(end_uhz), sample_period_us)?;
        let samples = whole_samples(ProfileKey::Sweep, sweep_us, sample_period_us, FEWEST_SAMPLES)?;
        let first_increment = fixed::increment(start_uhz, sample_period_us);
        let falling = end_uhz < start_uhz;
        Ok(Self {
            offset_micro,
            amplitude_micro,
            phase: 0,
            increment: first_increment,
            first_increment,
            growth_q64: growth_q64(start_uhz, end_uhz, samples),
            falling,
            samples,
            samples_left: samples,
            sweep: 0,
        })
    }

    pub(super) fn step(&mut self) -> Target {
        if self.samples_left == 0 {
            self.samples_left = self.samples;
            self.increment = self.first_increment;
            self.sweep = self.sweep.wrapping_add(1);
        }
        self.samples_left = self.samples_left.saturating_sub(1);
        let sine_q22 = fixed::sine_q22((self.phase >> 32) as u32);
        let value_micro =
            self.offset_micro.saturating_add(fixed::scale(self.amplitude_micro, i64::from(sine_q22), 22));
        self.phase = self.phase.wrapping_add(self.increment);
        let change = fixed::mul_high(self.increment, self.growth_q64);
        self.increment = if self.falling {
            self.increment.wrapping_sub(change)
        } else {
            self.increment.wrapping_add(change)
        };
        Target { value_micro, segment: self.sweep, ended: false }
    }
}

/// |(end/start)^(1/samples) - 1|, in 1/2^64, from the power series of exp.
fn growth_q64(start_uhz: u32, end_uhz: u32, samples: u32) -> u64 {
    const LN_2_Q64: u64 = 12_786_308_645_202_655_660;
    let octaves_q40 = fixed::log2_q40(u64::from(start_uhz)).abs_diff(fixed::log2_q40(u64::from(end_uhz)));
    // At most 32 octaves: 2^45 times 2^18 stays inside u64; 2^6 more come back by shifting the quotient.
    let per_sample_q58 = octaves_q40.wrapping_shl(18).checked_div(u64::from(samples)).unwrap_or(0);
    let x = fixed::mul_high(per_sample_q58, LN_2_Q64).wrapping_shl(6);
    let x2 = fixed::mul_high(x, x);
    let x3 = fixed::mul_high(x2, x);
    let x4 = fixed::mul_high(x3, x);
    if end_uhz < start_uhz {
        x.wrapping_sub(x2 / 2).wrapping_add(x3 / 6).wrapping_sub(x4 / 24)
    } else {
        x.wrapping_add(x2 / 2).wrapping_add(x3 / 6).wrapping_add(x4 / 24)
    }
}
