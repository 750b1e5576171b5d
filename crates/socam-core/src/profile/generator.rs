//! Samples of a profile: its shape, faded in and out, clamped and slew-limited.

use super::error::{ProfileError, ProfileKey};
use super::shape::{Profile, Shape};
use super::waveform::Waveform;
use crate::fixed;

/// One sample of a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Setpoint {
    /// The value, within the profile's limits.
    pub value_micro: i32,
    /// Number of the part of the shape, from 0, wrapping: level of a staircase, half period of a triangle, period of a sine,
    /// multisine or PRBS, sweep of a chirp.
    pub segment: u16,
    /// The amplitude or slew limit changed the value.
    pub limited: bool,
    /// The profile is fading to 0.
    pub stopping: bool,
    /// The profile has reached 0: this is its last sample.
    pub finished: bool,
}

/// A profile and its state, sample by sample.
#[derive(Debug, Clone, Copy)]
pub struct Generator {
    waveform: Waveform,
    limit_micro: i32,
    slew_per_sample: i32,
    envelope_q30: u32,
    envelope_step_q30: u32,
    samples_left: u64,
    stopping: bool,
    value_micro: i32,
}

const ENVELOPE_ONE: u32 = 1 << 30;

impl Generator {
    /// Checks `profile` and starts it at a sampling period.
    pub fn new(profile: &Profile, sample_period_us: u32) -> Result<Self, ProfileError> {
        if profile.limit_micro <= 0 {
            return Err(ProfileError::NotPositive(ProfileKey::Limit));
        }
        if profile.slew_micro_s == 0 {
            return Err(ProfileError::NotPositive(ProfileKey::Slew));
        }
        let samples_left = fixed::samples_in(profile.duration_us, sample_period_us);
        if samples_left == 0 {
            return Err(ProfileError::NotPositive(ProfileKey::Duration));
        }
        let (waveform, peak_micro) = Waveform::new(&profile.shape, sample_period_us)?;
        if peak_micro > i64::from(profile.limit_micro) {
            return Err(ProfileError::OverLimit { peak_micro, limit_micro: profile.limit_micro });
        }
        let slew = u64::from(profile.slew_micro_s).wrapping_mul(u64::from(sample_period_us)) / 1_000_000;
        let slew_per_sample = i32::try_from(slew).unwrap_or(i32::MAX);
        if slew_per_sample == 0 {
            return Err(ProfileError::SlewTooSlow);
        }
        let ramp_samples = fixed::samples_in(u64::from(profile.ramp_us), sample_period_us).max(1);
        let envelope_step = u64::from(ENVELOPE_ONE).div_ceil(ramp_samples);
        Ok(Self {
            waveform,
            limit_micro: profile.limit_micro,
            slew_per_sample,
            envelope_q30: 0,
            envelope_step_q30: u32::try_from(envelope_step).unwrap_or(ENVELOPE_ONE),
            samples_left,
            stopping: false,
            value_micro: 0,
        })
    }

    /// Begins the fade to 0.
    pub fn stop(&mut self) {
        self.stopping = true;
    }

    /// The next sample.
    pub fn step(&mut self) -> Setpoint {
        if self.samples_left == 0 {
            self.stopping = true;
        }
        self.samples_left = self.samples_left.saturating_sub(1);
        let target = self.waveform.step();
        self.stopping |= target.ended;
        self.envelope_q30 = if self.stopping {
            self.envelope_q30.saturating_sub(self.envelope_step_q30)
        } else {
            self.envelope_q30.saturating_add(self.envelope_step_q30).min(ENVELOPE_ONE)
        };

        let faded = fixed::scale(target.value_micro, i64::from(self.envelope_q30), 30);
        let clamped = fixed::within(faded, self.limit_micro);
        let lowest = self.value_micro.saturating_sub(self.slew_per_sample);
        let highest = self.value_micro.saturating_add(self.slew_per_sample);
        self.value_micro = clamped.max(lowest).min(highest);
        Setpoint {
            value_micro: self.value_micro,
            segment: target.segment,
            limited: self.value_micro != faded,
            stopping: self.stopping,
            finished: self.stopping && self.envelope_q30 == 0 && self.value_micro == 0,
        }
    }

    /// Largest magnitude of a shape. That of a multisine is found by computing one whole period, so only the host calls this; other
    /// shapes give it by their parameters.
    pub fn peak_micro(shape: &Shape, sample_period_us: u32) -> Result<i64, ProfileError> {
        let (mut waveform, peak_micro) = Waveform::new(shape, sample_period_us)?;
        let Shape::Multisine { period_us, .. } = *shape else {
            return Ok(peak_micro);
        };
        let samples = fixed::samples_in(u64::from(period_us), sample_period_us);
        let magnitudes = (0..samples).map(|_| i64::from(waveform.step().value_micro).saturating_abs());
        Ok(magnitudes.max().unwrap_or(0))
    }
}
