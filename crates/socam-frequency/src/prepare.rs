//! Preprocessing of signals as in section 4.1.1 of the thesis: outliers, low-pass filter, noise level.

use std::f64::consts::{PI, TAU};

use socam_spectrum::transform;

use crate::{FrequencyError, periods::median};

/// Number of samples on either side in the median window.
const NEIGHBOURS: usize = 5;
/// Factor from median absolute deviation to standard deviation of a normal distribution.
const NORMAL: f64 = 1.4826;

/// Replaces outliers by the median of their window and returns their number (Hampel identifier): samples that differ from the median
/// by more than `limit` standard deviations of the window. The standard deviation is at least that of the differences of the whole
/// signal, so that a quantised signal at rest has no outliers.
pub fn replace_outliers(values: &mut [f64], limit: f64) -> usize {
    let steps: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let usual = NORMAL * median(&steps) / std::f64::consts::SQRT_2;
    let original = values.to_vec();
    let mut replaced = 0;
    for index in 0..values.len() {
        let near = &original[index.saturating_sub(NEIGHBOURS)..(index + NEIGHBOURS + 1).min(original.len())];
        let middle = median(near);
        let deviations: Vec<f64> = near.iter().map(|value| (value - middle).abs()).collect();
        let spread = (NORMAL * median(&deviations)).max(usual);
        if (original[index] - middle).abs() > limit * spread && spread > 0.0 {
            values[index] = middle;
            replaced += 1;
        }
    }
    replaced
}

/// A Butterworth low-pass as a chain of second-order sections.
///
/// The same filter on input and output does not change the transfer function between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Butterworth {
    sections: Vec<Section>,
}

/// y = b0 x + b1 x1 + b2 x2 - a1 y1 - a2 y2.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

impl Butterworth {
    /// Designs a low-pass filter of this order and corner frequency (half power) for this sampling rate; the corner is exact
    /// (prewarped bilinear transform).
    ///
    /// # Errors
    /// [`FrequencyError::Filter`] if there is no such filter.
    pub fn new(order: usize, corner_hz: f64, rate_hz: f64) -> Result<Self, FrequencyError> {
        let possible = (1..=10).contains(&order) && corner_hz > 0.0 && corner_hz < 0.5 * rate_hz;
        if !possible {
            return Err(FrequencyError::Filter { order, corner_hz, rate_hz });
        }
        let warped = (PI * corner_hz / rate_hz).tan();
        let pair = |index: usize| {
            let damping = 2.0 * (PI * (2 * index + 1) as f64 / (2 * order) as f64).sin();
            let norm = 1.0 / (1.0 + damping * warped + warped * warped);
            let gain = warped * warped * norm;
            Section {
                b: [gain, 2.0 * gain, gain],
                a: [2.0 * (warped * warped - 1.0) * norm, (1.0 - damping * warped + warped * warped) * norm],
            }
        };
        let mut sections: Vec<Section> = (0..order / 2).map(pair).collect();
        if order % 2 == 1 {
            let norm = 1.0 / (1.0 + warped);
            sections
                .push(Section { b: [warped * norm, warped * norm, 0.0], a: [(warped - 1.0) * norm, 0.0] });
        }
        Ok(Self { sections })
    }

    /// The filtered signal. The filter starts at rest at the first value, so that a constant is not changed.
    #[must_use]
    pub fn filtered(&self, values: &[f64]) -> Vec<f64> {
        let mut signal = values.to_vec();
        for section in &self.sections {
            let start = signal.first().copied().unwrap_or(0.0);
            let (mut x, mut y) = ([start; 2], [start; 2]);
            for value in &mut signal {
                let input = *value;
                let output = section.b[0] * input + section.b[1] * x[0] + section.b[2] * x[1]
                    - section.a[0] * y[0]
                    - section.a[1] * y[1];
                (x, y) = ([input, x[0]], [output, y[0]]);
                *value = output;
            }
        }
        signal
    }
}

/// Standard deviation of white noise with the level of the upper half of the signal's spectrum; the level is the median of the lines,
/// which is robust against hum.
#[must_use]
pub fn noise_std(values: &[f64]) -> f64 {
    let length = values.len();
    if length < 16 {
        return 0.0;
    }
    // A window limits the leakage of trends.
    let mean = values.iter().sum::<f64>() / length as f64;
    let window = |t: usize| 0.5 - 0.5 * (TAU * t as f64 / length as f64).cos();
    let windowed: Vec<f64> = values.iter().enumerate().map(|(t, v)| (v - mean) * window(t)).collect();
    let power: Vec<f64> = transform(&windowed)[length / 4..].iter().map(|line| line.norm_sqr()).collect();
    // Lines of noise are exponentially distributed: their median is ln 2 of their mean; the window leaves 3/8 of the power.
    (median(&power) / std::f64::consts::LN_2 / (0.375 * length as f64)).sqrt()
}

#[cfg(test)]
mod tests {
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, Normal};

    use super::*;

    #[test]
    fn outliers_are_replaced_and_steps_are_not() {
        let mut values: Vec<f64> =
            (0..400).map(|t| f64::from(u8::from(t > 200)) + 0.01 * f64::from(t * 7 % 5)).collect();
        let clean = values.clone();
        (values[50], values[333]) = (5.0, -4.0);
        assert_eq!(replace_outliers(&mut values, 8.0), 2);
        let worst = values.iter().zip(&clean).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 0.05, "{worst}");
        let mut quantised: Vec<f64> = (0..400).map(|t| f64::from(u8::from(t % 97 == 0))).collect();
        quantised.truncate(10);
        replace_outliers(&mut quantised, 8.0);
    }

    #[test]
    fn a_butterworth_filter_halves_the_power_at_its_corner() {
        for order in [1, 2, 5] {
            let filter = Butterworth::new(order, 50.0, 1000.0).unwrap();
            let size = |hz: f64| {
                let wave: Vec<f64> = (0..4000).map(|t| (TAU * hz * f64::from(t) / 1000.0).sin()).collect();
                (filter.filtered(&wave)[2000..].iter().map(|v| v * v).sum::<f64>() / 1000.0).sqrt()
            };
            assert!((size(50.0) - 0.5_f64.sqrt()).abs() < 2e-3, "{order}: {}", size(50.0));
            let warped = (PI * 0.1).tan() / (PI * 0.05).tan();
            let wanted = (1.0 + warped.powi(2 * order as i32)).powf(-0.5);
            assert!((size(100.0) - wanted).abs() < 0.05 * wanted, "{order}: {} {wanted}", size(100.0));
            assert!((filter.filtered(&[3.0; 50])[49] - 3.0).abs() < 1e-12);
        }
        assert!(Butterworth::new(2, 600.0, 1000.0).is_err() && Butterworth::new(0, 1.0, 10.0).is_err());
    }

    #[test]
    fn noise_is_seen_beside_motion_and_hum() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let normal = Normal::new(0.0, 0.02).unwrap();
        let motion =
            |t: usize| 3.0 * (t as f64 * 0.004).sin() + 0.5 * (t as f64 * 2.5).sin() + t as f64 * 1e-3;
        let values: Vec<f64> = (0..10_000).map(|t| motion(t) + normal.sample(&mut random)).collect();
        assert!((noise_std(&values) / 0.02 - 1.0).abs() < 0.05, "{}", noise_std(&values));
    }
}
