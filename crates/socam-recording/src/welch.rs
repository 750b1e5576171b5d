//! Welch's method: Fourier transforms of windowed segments of a signal, whose mean square is its power density.

use std::sync::Arc;

use socam_fft::{Complex, RealToComplex};

/// Transforms segments of one length with a Hann window. The caller chooses the overlap (usually half) and sums over segments.
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
pub fn without_mean(values: &[f64]) -> impl Iterator<Item = f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(move |value| value - mean)
}
