//! Averaged spectra: densities, coherence, and their distribution by chance.

use realfft::num_complex::Complex;

/// Averaged spectra of `N` signals, made by [`Welch`](crate::Welch): one-sided, lines from zero to half the sampling rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectra<const N: usize = 1> {
    pub(crate) step_hz: f64,
    /// Factor from sums to densities.
    pub(crate) density_per_sum: f64,
    /// Width of the window's noise bandwidth, lines.
    pub(crate) noise_lines: f64,
    /// Variance of a density relative to that of as many independent segments.
    pub(crate) variance_factor: f64,
    pub(crate) segments: u64,
    pub(crate) power: [Vec<f64>; N],
    pub(crate) cross: [Vec<Complex<f64>>; N],
}

impl<const N: usize> Spectra<N> {
    /// Distance between lines, Hz.
    #[must_use]
    pub fn step_hz(&self) -> f64 {
        self.step_hz
    }

    /// Frequency of a line, Hz.
    #[must_use]
    pub fn frequency_hz(&self, line: usize) -> f64 {
        line as f64 * self.step_hz
    }

    /// Number of lines: from zero to half the sampling rate.
    #[must_use]
    pub fn lines(&self) -> usize {
        self.power.first().map_or(0, Vec::len)
    }

    /// Number of averaged segments.
    #[must_use]
    pub fn segments(&self) -> u64 {
        self.segments
    }

    /// Power density of a signal at each line, unit squared per Hz.
    #[must_use]
    pub fn density(&self, signal: usize) -> Vec<f64> {
        self.power[signal].iter().map(|power| power * self.density_per_sum).collect()
    }

    /// Squared coherence of a signal with the first at each line; 0 where either has no power.
    #[must_use]
    pub fn coherence(&self, signal: usize) -> Vec<f64> {
        let pairs = self.power[0].iter().zip(&self.power[signal]).zip(&self.cross[signal]);
        pairs
            .map(|((first, own), cross)| {
                let both = first * own;
                if both > 0.0 { cross.norm_sqr() / both } else { 0.0 }
            })
            .collect()
    }

    /// Degrees of freedom of a density: twice the number of independent segments.
    #[must_use]
    pub fn freedom(&self) -> f64 {
        2.0 * self.segments as f64 / self.variance_factor
    }

    /// Noise bandwidth of the window, Hz: the amplitude of a sine at a line is the root of twice its density times this. 1.5 lines of a
    /// Hann window.
    #[must_use]
    pub fn noise_bandwidth_hz(&self) -> f64 {
        self.noise_lines * self.step_hz
    }
}

/// Probability that independent signals reach a squared coherence at one line if their densities have `freedom` degrees of freedom (N. R.
/// Goodman, 1957).
///
/// ```
/// // Two segments: the coherence of independent signals is uniform between 0 and 1.
/// assert_eq!(socam_spectrum::coherence_p_value(0.75, 4.0), 0.25);
/// ```
#[must_use]
pub fn coherence_p_value(coherence: f64, freedom: f64) -> f64 {
    (1.0 - coherence.clamp(0.0, 1.0)).powf(0.5 * freedom - 1.0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::coherence_p_value;
    use crate::{Detrend, Welch, Window};

    /// White noise, uniform between -0.5 and 0.5: its variance is 1/12.
    fn noise(seed: u64) -> impl Iterator<Item = f64> {
        let mut state = seed;
        std::iter::repeat_with(move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        })
    }

    #[test]
    fn white_noise_has_its_density_and_a_delayed_copy_its_coherence() {
        let step_s = 1e-3;
        let input: Vec<f64> = noise(7).take(100_000).collect();
        let output: Vec<f64> = [0.0; 3].iter().chain(&input).map(|value| 2.5 * value).collect();
        let mut welch = Welch::new(1024);
        welch.add_run([&input, &output]);
        let spectra = welch.finish(step_s).unwrap();
        let density = spectra.density(0);
        let middle = density.iter().sum::<f64>() / density.len() as f64;
        assert!((middle / (2.0 * step_s / 12.0) - 1.0).abs() < 0.02, "{middle}");
        assert!(spectra.coherence(1)[1..512].iter().all(|coherence| *coherence > 0.99));
        assert_eq!(spectra.frequency_hz(512), 500.0);
    }

    #[test]
    fn the_scatter_of_densities_is_that_of_their_degrees_of_freedom() {
        let signal: Vec<f64> = noise(3).take(64 * 1000).collect();
        let choices =
            [(Window::Hann, 0.0), (Window::Hann, 0.5), (Window::Blackman, 0.75), (Window::Rectangular, 0.5)];
        for (window, overlap) in choices {
            let mut welch = Welch::new(64).with_window(window).with_overlap(overlap);
            let mut all = Vec::new();
            let mut freedom = 0.0;
            for part in signal.chunks(64 * 20) {
                welch.add_run([part]);
                let spectra = welch.finish(1.0).unwrap();
                freedom = spectra.freedom();
                // Every third line: the window couples neighbours.
                all.extend(spectra.density(0)[3..30].iter().step_by(3).copied());
            }
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            let variance = all.iter().map(|d| (d / mean - 1.0).powi(2)).sum::<f64>() / all.len() as f64;
            let expected = 2.0 / freedom;
            assert!((variance / expected - 1.0).abs() < 0.15, "{window:?} {overlap} {variance} {expected}");
        }
    }

    #[test]
    fn independent_signals_reach_a_coherence_as_often_as_chance_says() {
        let (mut random, mut above, mut all) = (noise(5), 0, 0);
        for _ in 0..200 {
            let signals: [Vec<f64>; 2] = std::array::from_fn(|_| random.by_ref().take(640).collect());
            let mut welch = Welch::new(64).without_overlap();
            welch.add_run([&signals[0], &signals[1]]);
            let spectra = welch.finish(1.0).unwrap();
            let own = spectra.coherence(1);
            assert_eq!(spectra.freedom(), 20.0);
            let lines = own[3..30].iter().step_by(3).filter(|own| coherence_p_value(**own, 20.0) < 0.1);
            above += lines.count();
            all += 9;
        }
        let share = above as f64 / f64::from(all);
        assert!((share - 0.1).abs() < 0.025, "{share}");
    }

    #[test]
    fn a_segment_with_a_missing_value_is_left_out() {
        let mut signal: Vec<f64> = noise(1).take(256).collect();
        let mut welch = Welch::new(64).without_overlap();
        signal[100] = f64::NAN;
        welch.add_run([&signal]);
        let found = welch.finish(1.0).unwrap();
        assert_eq!(found.segments(), 3);
        [0, 128, 192].into_iter().for_each(|start| welch.add([&signal[start..]]));
        assert_eq!(welch.finish(1.0).unwrap(), found);
        welch.add([&signal[200..]]);
        assert!(welch.finish(1.0).is_none(), "56 samples are no segment");
    }

    /// A sine between two lines: a flat top reads its amplitude, others lose up to 36 %; all do on a line, whatever trend lies below.
    #[test]
    fn each_window_reads_the_amplitude_of_a_sine() {
        let amplitude = |window: Window, line: f64, slope: f64| {
            let value = |k: u32| 3.0 * (TAU * line * f64::from(k) / 256.0).sin() + slope * f64::from(k);
            let signal: Vec<f64> = (0..2560).map(value).collect();
            let mut welch = Welch::new(256).with_window(window).with_detrend(Detrend::Line);
            welch.add_run([&signal]);
            let spectra = welch.finish(1e-3).unwrap();
            let greatest = spectra.density(0).into_iter().fold(0.0, f64::max);
            (2.0 * spectra.noise_bandwidth_hz() * greatest).sqrt()
        };
        for window in Window::ALL {
            assert!((amplitude(window, 60.0, 0.0) - 3.0).abs() < 0.01, "{window:?}");
            assert!((amplitude(window, 60.0, 5.0) - 3.0).abs() < 0.03, "{window:?} on a ramp");
        }
        let lost = Window::ALL.map(|window| 1.0 - amplitude(window, 60.5, 0.0) / 3.0);
        let expected = [0.15, 0.36, 0.00, 0.12];
        assert!(lost.iter().zip(expected).all(|(lost, expected)| (lost - expected).abs() < 0.01), "{lost:?}");
    }

    #[test]
    fn the_overlap_of_half_a_hann_window_costs_little() {
        let signal = vec![1.0; 256];
        let mut welch = Welch::new(64);
        welch.add_run([&signal]);
        let found = welch.finish(1.0).unwrap();
        // Spectra of neighbours correlate by 1/6, and 1 + 2/6² = 1.056.
        assert!((found.freedom() - 14.0 / (1.0 + 2.0 / 36.0)).abs() < 1e-3, "{}", found.freedom());
        assert!((found.noise_bandwidth_hz() * 64.0 - 1.5).abs() < 1e-9);
    }
}
