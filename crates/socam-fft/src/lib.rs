//! Plans of the fast Fourier transform of real signals.
//!
//! `realfft` is generic over the number type: every crate that plans with it compiles all transforms again, which takes ten seconds
//! of a processor. This crate compiles them once, for `f64`.

use std::sync::Arc;

use realfft::RealFftPlanner;

pub use realfft::num_complex::Complex;
pub use realfft::{ComplexToReal, RealToComplex};

/// The transform of `length` real samples into bins 0 to `length / 2`, unscaled.
#[inline(never)]
#[must_use]
pub fn forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    RealFftPlanner::new().plan_fft_forward(length)
}

/// The transform of bins 0 to `length / 2` into `length` real samples: `length` times the signal whose bins they are.
#[inline(never)]
#[must_use]
pub fn inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    RealFftPlanner::new().plan_fft_inverse(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forth_and_back_is_the_signal_times_its_length() {
        let signal = [1.0, -2.0, 0.5, 3.0, 0.25];
        let (there, back) = (forward(signal.len()), inverse(signal.len()));
        let (mut input, mut bins, mut output) =
            (signal.to_vec(), there.make_output_vec(), back.make_output_vec());
        there.process(&mut input, &mut bins).unwrap();
        assert!((bins[0] - Complex::new(2.75, 0.0)).norm() < 1e-14);
        back.process(&mut bins, &mut output).unwrap();
        for (value, back) in signal.iter().zip(&output) {
            assert!((5.0 * value - back).abs() < 1e-13);
        }
    }
}
