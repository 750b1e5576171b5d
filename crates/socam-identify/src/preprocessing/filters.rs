//! Zero-phase low-pass filters and differences, for methods that differentiate measured signals.

use nalgebra::Complex;

/// A second-order section, a0 = 1: y = b0 x + b1 x[-1] + b2 x[-2] - a1 y[-1] - a2 y[-2].
#[derive(Debug, Clone, Copy)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// Low-pass prototypes.
#[derive(Debug, Clone, Copy)]
enum Prototype {
    /// Flat, -3 dB at the cutoff.
    Butterworth,
    /// Chebyshev of the first kind with this ripple in dB up to the cutoff.
    Chebyshev(f64),
}

/// Second-order sections of a low-pass of even `order` with unit gain at zero frequency, by the bilinear transform with prewarping.
/// `cutoff` is a fraction of the Nyquist frequency.
fn sections(prototype: Prototype, order: usize, cutoff: f64) -> Vec<Section> {
    let warped = (std::f64::consts::FRAC_PI_2 * cutoff).tan();
    let (real, imaginary) = match prototype {
        Prototype::Butterworth => (1.0, 1.0),
        Prototype::Chebyshev(ripple_db) => {
            let mu = (1.0 / (10.0_f64.powf(ripple_db / 10.0) - 1.0).sqrt()).asinh() / order as f64;
            (mu.sinh(), mu.cosh())
        }
    };
    (0..order / 2)
        .map(|k| {
            let angle = std::f64::consts::PI * (2 * k + 1 + order) as f64 / (2 * order) as f64;
            let pole = Complex::new(real * angle.cos(), imaginary * angle.sin()) * warped;
            // (1 + s) over (1 - s) maps the pole; the pair gives a real section with unit gain at zero frequency.
            let z = (Complex::new(1.0, 0.0) + pole) / (Complex::new(1.0, 0.0) - pole);
            let a = [-2.0 * z.re, z.norm_sqr()];
            let gain = (1.0 + a[0] + a[1]) / 4.0;
            Section { b: [gain, 2.0 * gain, gain], a }
        })
        .collect()
}

impl Section {
    /// Filters in place. The initial state is that of a constant input equal to the first value.
    fn run(&self, signal: &mut [f64]) {
        let Some(first) = signal.first().copied() else { return };
        // Steady state of the transposed direct form II at unit gain.
        let mut z2 = (self.b[2] - self.a[1]) * first;
        let mut z1 = (self.b[1] - self.a[0]) * first + z2;
        for value in signal {
            let x = *value;
            let y = self.b[0] * x + z1;
            z1 = self.b[1] * x - self.a[0] * y + z2;
            z2 = self.b[2] * x - self.a[1] * y;
            *value = y;
        }
    }
}

/// Butterworth low-pass run forwards and backwards: zero phase, twice the order, -6 dB at `cutoff` (a fraction of the Nyquist
/// frequency).
pub(crate) fn low_pass(signal: &[f64], order: usize, cutoff: f64) -> Vec<f64> {
    both_ways(signal, &sections(Prototype::Butterworth, order, cutoff), order, cutoff)
}

/// Runs the sections forwards and backwards. The signal is extended at its ends by point reflection.
fn both_ways(signal: &[f64], sections: &[Section], order: usize, cutoff: f64) -> Vec<f64> {
    let (Some(first), Some(last)) = (signal.first(), signal.last()) else { return Vec::new() };
    let pad = (3 * (order + 1)).max((6.0 / cutoff) as usize).min(signal.len() - 1);
    let head = (1..=pad).rev().map(|k| 2.0 * first - signal[k]);
    let tail = (1..=pad).map(|k| 2.0 * last - signal[signal.len() - 1 - k]);
    let mut extended: Vec<f64> = head.chain(signal.iter().copied()).chain(tail).collect();
    for _ in 0..2 {
        sections.iter().for_each(|section| section.run(&mut extended));
        extended.reverse();
    }
    extended[pad..pad + signal.len()].to_vec()
}

/// Derivative per second by central differences, one-sided at the ends.
pub(crate) fn derivative(signal: &[f64], step_s: f64) -> Vec<f64> {
    let last = signal.len().saturating_sub(1);
    (0..signal.len())
        .map(|k| {
            let (left, right) = (k.saturating_sub(1), (k + 1).min(last));
            (signal[right] - signal[left]) / ((right - left).max(1) as f64 * step_s)
        })
        .collect()
}

/// Low-pass filters a signal and keeps every `factor`-th sample. The filter is zero-phase, at 0.8 of the new Nyquist frequency:
/// Chebyshev of order 8 with 0.05 dB of ripple, as in MATLAB's `decimate`.
pub(crate) fn decimate(signal: &[f64], factor: usize) -> Vec<f64> {
    let cutoff = 0.8 / factor as f64;
    let filtered = both_ways(signal, &sections(Prototype::Chebyshev(0.05), 8, cutoff), 8, cutoff);
    filtered.into_iter().step_by(factor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_the_slow_halves_at_cutoff_and_stops_the_fast() {
        let gain = |frequency: f64| {
            let tone: Vec<f64> =
                (0..4000).map(|k| (std::f64::consts::PI * frequency * f64::from(k)).sin()).collect();
            let filtered = low_pass(&tone, 4, 0.2);
            let size = |x: &[f64]| x[1000..3000].iter().map(|v| v * v).sum::<f64>().sqrt();
            size(&filtered) / size(&tone)
        };
        assert!((gain(0.02) - 1.0).abs() < 1e-3);
        assert!((gain(0.2) - 0.5).abs() < 2e-3, "-3 dB twice: {}", gain(0.2));
        assert!(gain(0.6) < 1e-4);
    }

    #[test]
    fn a_line_stays_a_line_and_has_its_sensitivity() {
        let line: Vec<f64> = (0..500).map(|k| 3.0 + 0.25 * f64::from(k)).collect();
        let filtered = low_pass(&line, 4, 0.1);
        assert!(line.iter().zip(&filtered).skip(100).take(300).all(|(a, b)| (a - b).abs() < 1e-6));
        assert!(derivative(&line, 0.5).iter().all(|sensitivity| (sensitivity - 0.5).abs() < 1e-12));
    }
}
