//! From a profile to its samples: the shape, faded in and out, clamped and slew-limited.

use super::chirp::Chirp;
use super::multisine::Multisine;
use super::prbs::Prbs;
use super::sine::Sine;
use super::staircase::Staircase;
use super::triangle::Triangle;
use super::{Profile, ProfileError, ProfileKey, Shape};
use crate::fixed;

/// One sample of a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Setpoint {
    /// The value, within the profile's limits.
    pub value_micro: i32,
    /// Which part of the course this is, counted from 0 and wrapping: level of a staircase, leg of a triangle, period of a sine,
    /// multisine or PRBS, sweep of a chirp.
    pub segment: u16,
    /// The amplitude or slew limit changed the value.
    pub limited: bool,
    /// The profile is on its way to 0.
    pub stopping: bool,
    /// The profile has arrived at 0: this was its last sample.
    pub finished: bool,
}

/// Where a profile stands.
#[derive(Debug, Clone, Copy)]
pub struct Generator {
    course: Course,
    limit_micro: i32,
    slew_per_sample: i32,
    envelope_q30: u32,
    envelope_step_q30: u32,
    samples_left: u64,
    stopping: bool,
    value_micro: i32,
}

/// A shape in progress.
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with, and there is one of it")]
#[derive(Debug, Clone, Copy)]
enum Course {
    Constant(i32),
    Staircase(Staircase),
    Sine(Sine),
    Triangle(Triangle),
    Chirp(Chirp),
    Prbs(Prbs),
    Multisine(Multisine),
}

/// The shape's wish at one sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wish {
    pub(super) value_micro: i32,
    pub(super) segment: u16,
    /// The shape has come to its own end.
    pub(super) ended: bool,
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
        let (course, peak_micro) = Course::new(&profile.shape, sample_period_us)?;
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
            course,
            limit_micro: profile.limit_micro,
            slew_per_sample,
            envelope_q30: 0,
            envelope_step_q30: u32::try_from(envelope_step).unwrap_or(ENVELOPE_ONE),
            samples_left,
            stopping: false,
            value_micro: 0,
        })
    }

    /// Begins the way to 0.
    pub fn stop(&mut self) {
        self.stopping = true;
    }

    /// The next sample.
    pub fn step(&mut self) -> Setpoint {
        if self.samples_left == 0 {
            self.stopping = true;
        }
        self.samples_left = self.samples_left.saturating_sub(1);
        let wish = self.course.step();
        self.stopping |= wish.ended;
        self.envelope_q30 = if self.stopping {
            self.envelope_q30.saturating_sub(self.envelope_step_q30)
        } else {
            self.envelope_q30.saturating_add(self.envelope_step_q30).min(ENVELOPE_ONE)
        };

        let faded = fixed::scale(wish.value_micro, i64::from(self.envelope_q30), 30);
        let clamped = fixed::within(faded, self.limit_micro);
        let lowest = self.value_micro.saturating_sub(self.slew_per_sample);
        let highest = self.value_micro.saturating_add(self.slew_per_sample);
        self.value_micro = clamped.max(lowest).min(highest);
        Setpoint {
            value_micro: self.value_micro,
            segment: wish.segment,
            limited: self.value_micro != faded,
            stopping: self.stopping,
            finished: self.stopping && self.envelope_q30 == 0 && self.value_micro == 0,
        }
    }

    /// The largest magnitude that a multisine reaches within one period, by going through it; other shapes say so in their
    /// parameters. Takes as long as the period has samples: for the host.
    pub fn peak_micro(shape: &Shape, sample_period_us: u32) -> Result<i64, ProfileError> {
        let (mut course, peak_micro) = Course::new(shape, sample_period_us)?;
        let Shape::Multisine { period_us, .. } = *shape else {
            return Ok(peak_micro);
        };
        let samples = fixed::samples_in(u64::from(period_us), sample_period_us);
        let magnitudes = (0..samples).map(|_| i64::from(course.step().value_micro).saturating_abs());
        Ok(magnitudes.max().unwrap_or(0))
    }
}

impl Course {
    /// The shape at its beginning, and its largest magnitude as far as the parameters tell.
    fn new(shape: &Shape, sample_period_us: u32) -> Result<(Self, i64), ProfileError> {
        let around = |offset: i32, amplitude: i32| {
            i64::from(offset).saturating_abs().saturating_add(i64::from(amplitude).saturating_abs())
        };
        Ok(match *shape {
            Shape::Constant { level_micro } => (Self::Constant(level_micro), around(level_micro, 0)),
            Shape::Staircase { first_micro, step_micro, count, dwell_us, and_back } => {
                let stairs =
                    Staircase::new(first_micro, step_micro, count, dwell_us, and_back, sample_period_us)?;
                (Self::Staircase(stairs), stairs.peak_micro())
            }
            Shape::Sine { offset_micro, amplitude_micro, frequency_uhz, periods } => (
                Self::Sine(Sine::new(
                    offset_micro,
                    amplitude_micro,
                    frequency_uhz,
                    periods,
                    sample_period_us,
                )?),
                around(offset_micro, amplitude_micro),
            ),
            Shape::Triangle { offset_micro, amplitude_micro, period_us } => (
                Self::Triangle(Triangle::new(offset_micro, amplitude_micro, period_us, sample_period_us)?),
                around(offset_micro, amplitude_micro),
            ),
            Shape::Chirp { offset_micro, amplitude_micro, start_uhz, end_uhz, sweep_us } => (
                Self::Chirp(Chirp::new(
                    offset_micro,
                    amplitude_micro,
                    start_uhz,
                    end_uhz,
                    sweep_us,
                    sample_period_us,
                )?),
                around(offset_micro, amplitude_micro),
            ),
            Shape::Prbs { offset_micro, amplitude_micro, bit_us, order, seed } => (
                Self::Prbs(Prbs::new(offset_micro, amplitude_micro, bit_us, order, seed, sample_period_us)?),
                around(offset_micro, amplitude_micro),
            ),
            Shape::Multisine { offset_micro, line_micro, period_us, lines, first_line, last_line, seed } => {
                let range = (first_line, last_line);
                let sines = Multisine::new(
                    offset_micro,
                    line_micro,
                    period_us,
                    lines,
                    range,
                    seed,
                    sample_period_us,
                )?;
                (Self::Multisine(sines), around(offset_micro, 0))
            }
        })
    }

    fn step(&mut self) -> Wish {
        match self {
            Self::Constant(value_micro) => Wish { value_micro: *value_micro, segment: 0, ended: false },
            Self::Staircase(course) => course.step(),
            Self::Sine(course) => course.step(),
            Self::Triangle(course) => course.step(),
            Self::Chirp(course) => course.step(),
            Self::Prbs(course) => course.step(),
            Self::Multisine(course) => course.step(),
        }
    }
}
