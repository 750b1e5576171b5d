//! A staircase: steady states, steps and reversals.

use super::checks::whole_samples;
use super::error::{ProfileError, ProfileKey};
use super::target::Target;
use crate::fixed;

#[derive(Debug, Clone, Copy)]
pub(super) struct Staircase {
    first_micro: i32,
    step_micro: i32,
    last_index: u16,
    and_back: bool,
    dwell: u32,
    index: u16,
    downwards: bool,
    samples_left: u32,
    segment: u16,
}

impl Staircase {
    pub(super) fn new(
        first_micro: i32,
        step_micro: i32,
        count: u16,
        dwell_us: u32,
        and_back: bool,
        sample_period_us: u32,
    ) -> Result<Self, ProfileError> {
        let last_index = count.checked_sub(1).ok_or(ProfileError::NotPositive(ProfileKey::Count))?;
        let dwell = whole_samples(ProfileKey::Dwell, dwell_us, sample_period_us, 1)?;
        Ok(Self {
            first_micro,
            step_micro,
            last_index,
            and_back,
            dwell,
            index: 0,
            downwards: false,
            samples_left: dwell,
            segment: 0,
        })
    }

    pub(super) fn peak_micro(&self) -> i64 {
        self.level(0).saturating_abs().max(self.level(self.last_index).saturating_abs())
    }

    fn level(&self, index: u16) -> i64 {
        i64::from(self.first_micro)
            .saturating_add(i64::from(self.step_micro).saturating_mul(i64::from(index)))
    }

    pub(super) fn step(&mut self) -> Target {
        if self.samples_left == 0 {
            self.samples_left = self.dwell;
            self.segment = self.segment.wrapping_add(1);
            self.next_level();
        }
        self.samples_left = self.samples_left.saturating_sub(1);
        Target { value_micro: fixed::saturate(self.level(self.index)), segment: self.segment, ended: false }
    }

    fn next_level(&mut self) {
        if self.and_back {
            if self.index == 0 {
                self.downwards = false;
            } else if self.index == self.last_index {
                self.downwards = true;
            }
        }
        self.index = if self.last_index == 0 || (!self.downwards && self.index == self.last_index) {
            0
        } else if self.downwards {
            self.index.saturating_sub(1)
        } else {
            self.index.saturating_add(1)
        };
    }
}
