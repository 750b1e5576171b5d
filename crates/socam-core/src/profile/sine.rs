//! A sine around an offset, for a number of periods: the thesis' program.

use super::checks::check_frequency;
use super::error::{ProfileError, ProfileKey};
use super::target::Target;
use crate::fixed;

#[derive(Debug, Clone, Copy)]
pub(super) struct Sine {
    offset_micro: i32,
    amplitude_micro: i32,
    /// 2^64 is one turn: no period drifts by a sample within any run.
    phase: u64,
    increment: u64,
    period: u16,
    periods: Option<u16>,
}

impl Sine {
    pub(super) fn new(
        offset_micro: i32,
        amplitude_micro: i32,
        frequency_uhz: u32,
        periods: Option<u16>,
        sample_period_us: u32,
    ) -> Result<Self, ProfileError> {
        check_frequency(u64::from(frequency_uhz), sample_period_us)?;
        if periods == Some(0) {
            return Err(ProfileError::NotPositive(ProfileKey::Periods));
        }
        let increment = fixed::increment(frequency_uhz, sample_period_us);
        Ok(Self { offset_micro, amplitude_micro, phase: 0, increment, period: 0, periods })
    }

    pub(super) fn step(&mut self) -> Target {
        let sine_q22 = fixed::sine_q22((self.phase >> 32) as u32);
        let value_micro =
            self.offset_micro.saturating_add(fixed::scale(self.amplitude_micro, i64::from(sine_q22), 22));
        let segment = self.period;
        let ended = self.periods.is_some_and(|periods| segment >= periods);
        let (phase, wrapped) = self.phase.overflowing_add(self.increment);
        self.phase = phase;
        self.period = self.period.wrapping_add(u16::from(wrapped));
        Target { value_micro, segment, ended }
    }
}
