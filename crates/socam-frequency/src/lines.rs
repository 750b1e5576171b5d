//! One line of a frequency response, with its uncertainty.

use nalgebra::Complex;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Lines whose windows overlap by at most half: a fit to all lines would underestimate its uncertainty, since they share data.
/// Parabolas in windows of n bins, half a window apart, weigh the information of n bins by 2 / 2.25.
#[must_use]
pub fn apart(lines: &[Line]) -> Vec<Line> {
    let mut kept: Vec<Line> = Vec::new();
    for line in lines {
        if kept.last().is_none_or(|last| line.frequency_hz - last.frequency_hz >= 0.5 * line.width_hz) {
            kept.push(*line);
        }
    }
    kept
}

/// The response at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Hz.
    pub frequency_hz: f64,
    /// Output over input.
    pub response: Complex<f64>,
    /// Mean square of its complex error.
    pub variance: f64,
    /// Complex degrees of freedom that the variance was estimated with; infinite where it is known.
    pub freedom: f64,
    /// Width of the window that it was estimated from, Hz; 0 if the line has a bin of its own. Lines closer than half of it are not
    /// independent.
    pub width_hz: f64,
    /// Coherence, 0 to 1: the share of the power of both signals that is linearly related, within one period (or the window of the
    /// line).
    pub coherence: f64,
}

impl Line {
    /// Half-width of the 95 % interval of the error's part in any one direction: of the magnitude, and of the phase in rad times
    /// the magnitude, where it is small against the response.
    #[must_use]
    pub fn half_width(&self) -> f64 {
        let quantile = StudentsT::new(0.0, 1.0, 2.0 * self.freedom).map_or(1.96, |t| t.inverse_cdf(0.975));
        quantile * (0.5 * self.variance).sqrt()
    }

    /// Radius of the 95 % confidence circle about [`Self::response`].
    #[must_use]
    pub fn radius(&self) -> f64 {
        // The ratio to the variance has an F distribution with 2 and 2 q degrees of freedom, whose quantile has a closed form.
        let q = self.freedom;
        (self.variance * q * (0.05_f64.powf(-1.0 / q) - 1.0)).sqrt()
    }

    /// Coherence below which the 95 % confidence circle would hold zero, were the noise larger by a factor and all else as it is;
    /// `None` for a line without noise.
    #[must_use]
    pub fn threshold_coherence(&self) -> Option<f64> {
        // Power of noise over power of signal; the variance is in proportion to it.
        let noise = 1.0 / self.coherence - 1.0;
        let factor = self.response.norm_sqr() / self.radius().powi(2);
        let threshold = 1.0 / (1.0 + noise * factor);
        (threshold > 0.0 && threshold < 1.0).then_some(threshold)
    }

    /// 95 % interval of the magnitude.
    #[must_use]
    pub fn magnitude_ci95(&self) -> [f64; 2] {
        let (size, half) = (self.response.norm(), self.half_width());
        [(size - half).max(0.0), size + half]
    }

    /// Half-width of the phase's 95 % interval, degrees; 180 if the response is not significant.
    #[must_use]
    pub fn phase_half_width_deg(&self) -> f64 {
        let share = self.half_width() / self.response.norm();
        if share < 1.0 { share.asin().to_degrees() } else { 180.0 }
    }

    /// Joins two independent estimates of the same line.
    #[must_use]
    pub(crate) fn joined(self, other: Self) -> Self {
        let (mine, others) = (1.0 / self.variance, 1.0 / other.variance);
        let total = mine + others;
        Self {
            frequency_hz: self.frequency_hz,
            response: (self.response * mine + other.response * others) / total,
            variance: 1.0 / total,
            freedom: self.freedom + other.freedom,
            width_hz: self.width_hz.max(other.width_hz),
            coherence: (self.coherence * mine + other.coherence * others) / total,
        }
    }
}
