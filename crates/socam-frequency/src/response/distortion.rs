//! Distortion: the power of the output at lines that the input does not drive.

use nalgebra::Complex;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::lines::Line;
use crate::periodic::Periodic;

/// Probability that noise alone counts as distortion.
const FALSE_ALARM: f64 = 1e-3;

/// Power of the output at lines that are not excited.
#[derive(Debug, Clone, PartialEq)]
pub struct Distortion {
    /// Even multiples of the base frequency.
    pub even: Option<Parity>,
    /// Odd ones.
    pub odd: Option<Parity>,
    /// All lines of the output.
    pub lines: Vec<OutputLine>,
}

/// Lines of one parity that are not excited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parity {
    /// Number of lines.
    pub lines: usize,
    /// Root mean square distortion per line relative to that of the excited output lines, less noise, dB.
    pub level_db: Option<f64>,
    /// Noise in the same measure, dB.
    pub noise_db: f64,
    /// Mean power over that of noise.
    pub over_noise: f64,
    /// Probability that noise alone reaches this ratio.
    pub p_value: f64,
    /// Whether it is significant.
    pub significant: bool,
}

/// Kind of an output line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Driven {
    /// The input drives it.
    Excited,
    /// An even multiple that is not excited.
    Even,
    /// An odd multiple that is not excited.
    Odd,
}

/// A line of the output's spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputLine {
    /// Hz.
    pub frequency_hz: f64,
    /// Kind.
    pub driven: Driven,
    /// Amplitude; at a line that is not excited, without the response to the remaining input.
    pub amplitude: f64,
    /// Standard deviation of its noise.
    pub noise: f64,
}

/// Distortion from the output lines that the input does not drive; `None` where every line is driven.
pub(super) fn distortion(records: &[Periodic], lines: &[Line], to_hz: f64) -> Option<Distortion> {
    if lines.is_empty() {
        return None;
    }
    let (output, freedom) = output_lines(records, lines, to_hz);
    let power = |driven: Driven| {
        let own: Vec<&OutputLine> = output.iter().filter(|line| line.driven == driven).collect();
        let sum = |of: &dyn Fn(&OutputLine) -> f64| own.iter().map(|line| of(line)).sum::<f64>();
        (
            own.len(),
            sum(&|l| l.amplitude.powi(2)),
            sum(&|l| l.noise.powi(2)),
            sum(&|l| (l.amplitude / l.noise).powi(2)),
        )
    };
    let (count, driven_power, ..) = power(Driven::Excited);
    let reference = driven_power / count.max(1) as f64;
    let decibel = |power: f64| 10.0 * (power / reference).log10();
    let parity = |driven: Driven| {
        let (lines, total, noise, ratios) = power(driven);
        if lines == 0 || noise <= 0.0 {
            return None;
        }
        let over_noise = ratios / lines as f64;
        // Neighbouring lines share most of the bins from which their noise is estimated.
        let shared = (freedom * lines as f64 / 4.0).max(freedom);
        let p_value = FisherSnedecor::new(2.0 * lines as f64, 2.0 * shared).map_or(1.0, |f| f.sf(over_noise));
        let own = total - noise;
        let significant = p_value < FALSE_ALARM;
        Some(Parity {
            lines,
            level_db: (own > 0.0 && significant).then(|| decibel(own / lines as f64)),
            noise_db: decibel(noise / lines as f64),
            over_noise,
            p_value,
            significant,
        })
    };
    let (even, odd) = (parity(Driven::Even), parity(Driven::Odd));
    (even.is_some() || odd.is_some()).then_some(Distortion { even, odd, lines: output })
}

/// Lines of the output up to a frequency, and the degrees of freedom of their noise.
fn output_lines(records: &[Periodic], lines: &[Line], to_hz: f64) -> (Vec<OutputLine>, f64) {
    let mut output = Vec::new();
    let mut freedom = 0.0_f64;
    for record in records {
        for harmonic in record.harmonics.iter().filter(|h| h.frequency_hz <= to_hz) {
            let even = harmonic.order.is_multiple_of(2);
            let (driven, value) = if harmonic.excited {
                (Driven::Excited, harmonic.output)
            } else {
                let rest = record.error(harmonic, between(lines, harmonic.frequency_hz));
                (if even { Driven::Even } else { Driven::Odd }, rest)
            };
            freedom = harmonic.freedom;
            let scale = 2.0 / record.samples() as f64;
            output.push(OutputLine {
                frequency_hz: harmonic.frequency_hz,
                driven,
                amplitude: scale * value.value.norm(),
                noise: scale * value.variance.sqrt(),
            });
        }
    }
    (output, freedom)
}

/// Linear interpolation of the response between lines; constant beyond the ends.
fn between(lines: &[Line], frequency_hz: f64) -> Complex<f64> {
    let after = lines.partition_point(|line| line.frequency_hz < frequency_hz);
    let (Some(low), Some(high)) = (lines.get(after.saturating_sub(1)), lines.get(after.min(lines.len() - 1)))
    else {
        return Complex::default();
    };
    let span = high.frequency_hz - low.frequency_hz;
    let share = if span > 0.0 { ((frequency_hz - low.frequency_hz) / span).clamp(0.0, 1.0) } else { 0.0 };
    low.response * (1.0 - share) + high.response * share
}
