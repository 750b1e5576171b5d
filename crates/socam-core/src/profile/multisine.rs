//! A random-phase multisine, exactly periodic.

use super::checks::{check_frequency, whole_samples};
use super::clock::PeriodClock;
use super::error::{ProfileError, ProfileKey};
use super::shape::{Lines, MAX_LINES};
use super::target::Target;
use crate::fixed;

#[derive(Debug, Clone, Copy)]
pub(super) struct Multisine {
    offset_micro: i32,
    line_micro: i32,
    clock: PeriodClock,
    first: u32,
    stride: u32,
    count: u32,
    /// Phase of each line at the start of a period. Stored, because a tick is too short to compute them again.
    phases: [u32; MAX_LINES as usize],
}

impl Multisine {
    pub(super) fn new(
        offset_micro: i32,
        line_micro: i32,
        period_us: u32,
        lines: Lines,
        (first_line, last_line): (u16, u16),
        seed: u32,
        sample_period_us: u32,
    ) -> Result<Self, ProfileError> {
        let period = whole_samples(ProfileKey::Period, period_us, sample_period_us, 2)?;
        let first_line = u32::from(first_line.max(1));
        let (first, stride) = match lines {
            Lines::Full => (first_line, 1),
            Lines::Odd => (first_line | 1, 2),
            Lines::Even => (first_line.wrapping_add(first_line & 1), 2),
        };
        let last = u32::from(last_line);
        let count =
            last.checked_sub(first).map_or(0, |span| span.checked_div(stride).unwrap_or(0).wrapping_add(1));
        if !(1..=MAX_LINES).contains(&count) {
            return Err(ProfileError::LineCount(count));
        }
        let highest_uhz =
            u64::from(last).wrapping_mul(1_000_000_000_000).checked_div(u64::from(period_us)).unwrap_or(0);
        check_frequency(highest_uhz, sample_period_us)?;
        let mut phases = [0; MAX_LINES as usize];
        phases.iter_mut().zip(0..).for_each(|(phase, line)| *phase = fixed::mix(seed, line));
        Ok(Self { offset_micro, line_micro, clock: PeriodClock::new(period), first, stride, count, phases })
    }

    pub(super) fn step(&mut self) -> Target {
        let segment = self.clock.periods;
        let base = self.clock.step();
        let sum_q22 = self.sum_q22(base);
        let swing = fixed::scale(self.line_micro, i64::from(sum_q22), 22);
        Target { value_micro: self.offset_micro.saturating_add(swing), segment, ended: false }
    }

    /// Sum of all lines at one phase: at most 256 terms of at most 2^22. This is most of a tick's time; the function is not inlined, so
    /// that the loop has all of the processor's few registers.
    #[inline(never)]
    fn sum_q22(&self, base: u32) -> i32 {
        let phase_step = base.wrapping_mul(self.stride);
        let mut phase = base.wrapping_mul(self.first);
        let mut sum_q22 = 0i32;
        for &at_start in self.phases.iter().take(self.count as usize) {
            sum_q22 = sum_q22.wrapping_add(fixed::sine_q22(phase.wrapping_add(at_start)));
            phase = phase.wrapping_add(phase_step);
        }
        sum_q22
    }
}
