//! The shape of a profile, sample by sample.

use super::chirp::Chirp;
use super::error::ProfileError;
use super::multisine::Multisine;
use super::prbs::Prbs;
use super::shape::Shape;
use super::sine::Sine;
use super::staircase::Staircase;
use super::target::Target;
use super::triangle::Triangle;

/// A shape and its state.
#[expect(clippy::large_enum_variant, reason = "no allocator to box with, and only one instance")]
#[derive(Debug, Clone, Copy)]
pub(super) enum Waveform {
    Constant(i32),
    Staircase(Staircase),
    Sine(Sine),
    Triangle(Triangle),
    Chirp(Chirp),
    Prbs(Prbs),
    Multisine(Multisine),
}

impl Waveform {
    /// The shape at its start, and its largest magnitude (of a multisine only that of its offset).
    pub(super) fn new(shape: &Shape, sample_period_us: u32) -> Result<(Self, i64), ProfileError> {
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

    pub(super) fn step(&mut self) -> Target {
        match self {
            Self::Constant(value_micro) => Target { value_micro: *value_micro, segment: 0, ended: false },
            Self::Staircase(shape) => shape.step(),
            Self::Sine(shape) => shape.step(),
            Self::Triangle(shape) => shape.step(),
            Self::Chirp(shape) => shape.step(),
            Self::Prbs(shape) => shape.step(),
            Self::Multisine(shape) => shape.step(),
        }
    }
}
