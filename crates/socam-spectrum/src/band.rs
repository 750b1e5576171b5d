//! The part of a signal within a band of frequencies.

use crate::fourier::transform;

/// Sum of the squares of a signal's part within a band, Hz, both ends included, its mean removed: a zero-phase filter with ideal edges.
///
/// ```
/// // A sine of amplitude 2 at 20 Hz, sampled at 1 kHz for 1 s: its 1000 squares have the mean 2.
/// let sine: Vec<f64> = (0..1000).map(|k| 2.0 * (std::f64::consts::TAU * 0.02 * f64::from(k)).sin()).collect();
/// assert!((socam_spectrum::square_within(&sine, 1e-3, [10.0, 20.0]) - 2000.0).abs() < 1e-6);
/// assert!(socam_spectrum::square_within(&sine, 1e-3, [21.0, 500.0]) < 1e-6);
/// ```
#[must_use]
pub fn square_within(signal: &[f64], sample_time_s: f64, [low_hz, high_hz]: [f64; 2]) -> f64 {
    let rows = signal.len();
    let mean = signal.iter().sum::<f64>() / rows as f64;
    let swing: Vec<f64> = signal.iter().map(|value| value - mean).collect();
    let step_hz = 1.0 / (rows as f64 * sample_time_s);
    let lines = transform(&swing).into_iter().enumerate().skip(1);
    let within = lines.filter(|(line, _)| (low_hz..=high_hz).contains(&(*line as f64 * step_hz)));
    // Each line counts twice, for its negative frequency too, except the line at half the sampling rate.
    let squares =
        within.map(|(line, value)| if 2 * line == rows { value.norm_sqr() } else { 2.0 * value.norm_sqr() });
    squares.sum::<f64>() / rows as f64
}
