//! Welch's method: the power density of a signal is the mean square of the Fourier transforms of its windowed segments (P. D. Welch, IEEE
//! Trans. Audio Electroacoustics 15, 1967).

use std::sync::Arc;

use socam_fft::{Complex, RealToComplex};

/// Transforms segments of one length with a Hann window. The caller chooses the overlap (usually half) and sums over segments.
///
/// ```
/// use socam_recording::Welch;
///
/// // A sine of amplitude 2 in 8 periods per segment of 64 samples at 1 kHz has the power 2.
/// let sine: Vec<f64> = (0..64).map(|k| 2.0 * (std::f64::consts::TAU * 8.0 * f64::from(k) / 64.0).sin()).collect();
/// let mut welch = Welch::new(64);
/// let power: f64 = welch.transform(sine).iter().map(|line| line.norm_sqr()).sum();
/// let power = power * welch.density_per_sum(1e-3, 1) * welch.step_hz(1e-3);
/// assert!((power - 2.0).abs() < 0.01, "{power}");
/// assert_eq!((welch.length(), welch.lines()), (64, 33));
/// ```
pub struct Welch {
    fft: Arc<dyn RealToComplex<f64>>,
    window: Vec<f64>,
    input: Vec<f64>,
    output: Vec<Complex<f64>>,
}

impl std::fmt::Debug for Welch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Welch").field("length", &self.length()).finish_non_exhaustive()
    }
}

impl Welch {
    /// For segments of `length` samples; at least one.
    #[must_use]
    pub fn new(length: usize) -> Self {
        let length = length.max(1);
        let fft = socam_fft::forward(length);
        let turn = std::f64::consts::TAU / length as f64;
        Self {
            window: (0..length).map(|k| 0.5 - 0.5 * (turn * (k as f64 + 0.5)).cos()).collect(),
            input: vec![0.0; length],
            output: fft.make_output_vec(),
            fft,
        }
    }

    /// Number of samples of a segment.
    #[must_use]
    pub fn length(&self) -> usize {
        self.window.len()
    }

    /// Number of lines of a transform: from zero to half the sampling frequency.
    #[must_use]
    pub fn lines(&self) -> usize {
        self.output.len()
    }

    /// The transform of the first segment of these values, padded with zeros. A value that is not finite makes all lines not finite.
    pub fn transform(&mut self, values: impl IntoIterator<Item = f64>) -> &[Complex<f64>] {
        let mut values = values.into_iter();
        for (input, weight) in self.input.iter_mut().zip(&self.window) {
            *input = values.next().unwrap_or(0.0) * weight;
        }
        // It fails only for buffers of a wrong length, and these have the right one.
        if self.fft.process(&mut self.input, &mut self.output).is_err() {
            self.output.fill(Complex::new(f64::NAN, f64::NAN));
        }
        &self.output
    }

    /// Distance of lines, Hz, for samples every `step_s`.
    #[must_use]
    pub fn step_hz(&self, step_s: f64) -> f64 {
        1.0 / (step_s * self.length() as f64)
    }

    /// Factor from the sum of squared lines over this many segments to the one-sided power density, unit squared per Hz.
    #[must_use]
    pub fn density_per_sum(&self, step_s: f64, pieces: u64) -> f64 {
        let weight: f64 = self.window.iter().map(|weight| weight * weight).sum();
        2.0 * step_s / (weight * pieces.max(1) as f64)
    }
}

/// Values minus their mean.
///
/// ```
/// assert_eq!(socam_recording::without_mean(&[1.0, 3.0]).collect::<Vec<_>>(), [-1.0, 1.0]);
/// ```
pub fn without_mean(values: &[f64]) -> impl Iterator<Item = f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(move |value| value - mean)
}
