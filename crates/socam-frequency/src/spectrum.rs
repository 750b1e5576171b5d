//! The discrete Fourier transform, and frequencies of its bins.

use nalgebra::Complex;

/// Bins 0 to N/2 of the transform of `values`, unscaled.
pub(crate) fn transform(values: &[f64]) -> Vec<Complex<f64>> {
    if values.is_empty() {
        return Vec::new();
    }
    let plan = socam_fft::forward(values.len());
    let (mut input, mut output) = (values.to_vec(), plan.make_output_vec());
    // It only fails for buffers of a wrong length, and these are its own.
    if plan.process(&mut input, &mut output).is_err() {
        output.clear();
    }
    output
}

/// Autocorrelation at all lags below the length, of `values` without their mean.
pub(crate) fn autocorrelation(values: &[f64]) -> Vec<f64> {
    let length = values.len();
    let mean = values.iter().sum::<f64>() / length.max(1) as f64;
    let mut padded: Vec<f64> = values.iter().map(|value| value - mean).collect();
    padded.resize((2 * length).next_power_of_two(), 0.0);
    let mut power = transform(&padded);
    power.iter_mut().for_each(|line| *line = Complex::new(line.norm_sqr(), 0.0));
    let plan = socam_fft::inverse(padded.len());
    if plan.process(&mut power, &mut padded).is_err() {
        return Vec::new();
    }
    let scale = 1.0 / padded.len() as f64;
    padded.truncate(length);
    padded.iter_mut().for_each(|value| *value *= scale);
    padded
}
