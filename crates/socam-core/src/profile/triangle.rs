//! A triangle: a slow sweep in both directions, whose difference shows friction.

use super::checks::whole_samples;
use super::clock::PeriodClock;
use super::error::{ProfileError, ProfileKey};
use super::target::Target;
use crate::fixed;

#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    offset_micro: i32,
    amplitude_micro: i32,
    clock: PeriodClock,
    falling: bool,
    leg: u16,
}

const QUARTER: u32 = 1 << 30;

impl Triangle {
    pub(super) fn new(
        offset_micro: i32,
        amplitude_micro: i32,
        period_us: u32,
        sample_period_us: u32,
    ) -> Result<Self, ProfileError> {
        let period = whole_samples(ProfileKey::Period, period_us, sample_period_us, 4)?;
        Ok(Self { offset_micro, amplitude_micro, clock: PeriodClock::new(period), falling: false, leg: 0 })
    }

    pub(super) fn step(&mut self) -> Target {
        // Seen from the lowest point, the first half turn rises and the second falls.
        let from_lowest = self.clock.step().wrapping_add(QUARTER);
        let falling = from_lowest >> 31 == 1;
        let height_q30 = if falling {
            (3 * QUARTER).wrapping_sub(from_lowest) as i32
        } else {
            from_lowest.wrapping_sub(QUARTER) as i32
        };
        if falling != self.falling {
            self.falling = falling;
            self.leg = self.leg.wrapping_add(1);
        }
        let swing = fixed::scale(self.amplitude_micro, i64::from(height_q30), 30);
        Target { value_micro: self.offset_micro.saturating_add(swing), segment: self.leg, ended: false }
    }
}
