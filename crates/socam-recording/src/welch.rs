//! Welch's method: the transforms of windowed pieces of a signal, whose mean square is its power density.

use std::sync::Arc;

use socam_fft::{Complex, RealToComplex};

/// Transforms pieces of one length through a Hann window. How pieces follow each other (half overlapping is usual) and what is
/// summed up over them is the caller's.
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
    /// For pieces of `length` samples; at least one.
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

    /// Samples in a piece.
    #[must_use]
    pub fn length(&self) -> usize {
        self.window.len()
    }

    /// Lines in a transform: from zero to half the sampling frequency.
    #[must_use]
    pub fn lines(&self) -> usize {
        self.output.len()
    }

    /// The transform of the piece that these values begin with. A value that is not finite makes all lines so; where there are too
    /// few values, zeros follow.
    pub fn transform(&mut self, values: impl IntoIterator<Item = f64>) -> &[Complex<f64>] {
        let mut values = values.into_iter();
        for (input, weight) in self.input.iter_mut().zip(&self.window) {
            *input = values.next().unwrap_or(0.0) * weight;
        }
        // It only fails for buffers of a wrong length, and these are its own.
        if self.fft.process(&mut self.input, &mut self.output).is_err() {
            self.output.fill(Complex::new(f64::NAN, f64::NAN));
        }
        &self.output
    }

    /// Hz from line to line, for samples every `step_s`.
    #[must_use]
    pub fn step_hz(&self, step_s: f64) -> f64 {
        1.0 / (step_s * self.length() as f64)
    }

    /// What turns a sum of squared lines over so many pieces into a one-sided power density, unit squared per Hz.
    #[must_use]
    pub fn density_per_sum(&self, step_s: f64, pieces: u64) -> f64 {
        let weight: f64 = self.window.iter().map(|weight| weight * weight).sum();
        2.0 * step_s / (weight * pieces.max(1) as f64)
    }
}

/// Values less their mean.
pub fn without_mean(values: &[f64]) -> impl Iterator<Item = f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(move |value| value - mean)
}
