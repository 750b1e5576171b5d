//! The discrete Fourier transform of real signals.
//!
//! `realfft` is generic over the number type: every crate that plans transforms with it compiles all of them, which takes 10 s of processor
//! time. This file compiles them once, for `f64`.

use std::sync::Arc;

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex, num_complex::Complex};

/// The transform of `length` real samples into bins 0 to `length / 2`, unscaled.
#[inline(never)]
pub(crate) fn forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    RealFftPlanner::new().plan_fft_forward(length)
}

/// The transform of bins 0 to `length / 2` into `length` real samples: `length` times the signal whose bins they are.
#[inline(never)]
fn inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    RealFftPlanner::new().plan_fft_inverse(length)
}

/// Bins 0 to N/2 of the discrete Fourier transform of N values, unscaled; empty without values.
///
/// ```
/// let bins = socam_spectrum::transform(&[1.0, 0.0, -1.0, 0.0]);
/// assert_eq!(bins.iter().map(|bin| bin.re).collect::<Vec<_>>(), [0.0, 2.0, 0.0]);
/// ```
#[must_use]
pub fn transform(values: &[f64]) -> Vec<Complex<f64>> {
    if values.is_empty() {
        return Vec::new();
    }
    let plan = forward(values.len());
    let (mut input, mut output) = (values.to_vec(), plan.make_output_vec());
    // The transform fails only for buffers of a wrong length, and these have the right length.
    if plan.process(&mut input, &mut output).is_err() {
        output.clear();
    }
    output
}

/// Autocorrelation at all lags below the length, of `values` without their mean: sums of products, not divided by their number.
///
/// ```
/// let correlation = socam_spectrum::autocorrelation(&[1.0, -1.0, 1.0, -1.0]);
/// assert!(correlation.iter().zip([4.0, -3.0, 2.0, -1.0]).all(|(found, exact)| (found - exact).abs() < 1e-12));
/// ```
#[must_use]
pub fn autocorrelation(values: &[f64]) -> Vec<f64> {
    let length = values.len();
    let mean = values.iter().sum::<f64>() / length.max(1) as f64;
    let mut padded: Vec<f64> = values.iter().map(|value| value - mean).collect();
    padded.resize((2 * length).next_power_of_two(), 0.0);
    let mut power = transform(&padded);
    power.iter_mut().for_each(|line| *line = Complex::new(line.norm_sqr(), 0.0));
    let plan = inverse(padded.len());
    if plan.process(&mut power, &mut padded).is_err() {
        return Vec::new();
    }
    let scale = 1.0 / padded.len() as f64;
    padded.truncate(length);
    padded.iter_mut().for_each(|value| *value *= scale);
    padded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forth_and_back_is_the_signal_times_its_length() {
        let signal = [1.0, -2.0, 0.5, 3.0, 0.25];
        let mut bins = transform(&signal);
        assert!((bins[0] - Complex::new(2.75, 0.0)).norm() < 1e-14);
        let back = inverse(signal.len());
        let mut output = back.make_output_vec();
        back.process(&mut bins, &mut output).unwrap();
        for (value, back) in signal.iter().zip(&output) {
            assert!((5.0 * value - back).abs() < 1e-13);
        }
        assert!(transform(&[]).is_empty());
    }
}
