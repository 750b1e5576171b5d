//! Welch's method: the power density of a signal is the mean square of the Fourier transforms of its windowed segments (P. D. Welch, IEEE
//! Trans. Audio Electroacoustics 15, 1967).

use std::sync::Arc;

use realfft::{RealToComplex, num_complex::Complex};

use crate::{Detrend, Window, fourier::forward, spectra::Spectra};

/// Averages the spectra of `N` simultaneous signals over segments of one length.
///
/// Segments may come from anywhere in the signals: those of [`Self::add_run`] overlap, by half unless [`Self::with_overlap`] says
/// otherwise; [`Self::add`] takes any segment. They are weighted by a Hann window after their mean is removed, unless
/// [`Self::with_window`] and [`Self::with_detrend`] say otherwise. A segment with a value that is not finite is left out.
///
/// ```
/// use socam_spectrum::Welch;
///
/// // A sine of amplitude 2 in 8 periods per segment of 64 samples at 1 kHz has the power 2.
/// let sine: Vec<f64> = (0..640).map(|k| 2.0 * (std::f64::consts::TAU * 8.0 * f64::from(k) / 64.0).sin()).collect();
/// let mut welch = Welch::new(64);
/// welch.add_run([&sine]);
/// let spectra = welch.finish(1e-3).expect("whole segments");
/// let power = spectra.density(0).iter().sum::<f64>() * spectra.step_hz();
/// assert!((power - 2.0).abs() < 0.01, "{power}");
/// assert_eq!((spectra.segments(), spectra.lines()), (19, 33));
/// // `finish` begins anew.
/// assert!(welch.finish(1e-3).is_none());
/// ```
pub struct Welch<const N: usize = 1> {
    fft: Arc<dyn RealToComplex<f64>>,
    window: Vec<f64>,
    hop: usize,
    detrend: Detrend,
    input: Vec<f64>,
    /// Transforms of the present segment.
    lines: [Vec<Complex<f64>>; N],
    /// Sums of squares of each signal, and of products of each with the conjugate of the first.
    power: [Vec<f64>; N],
    cross: [Vec<Complex<f64>>; N],
    segments: u64,
}

impl<const N: usize> std::fmt::Debug for Welch<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Welch").field("length", &self.length()).finish_non_exhaustive()
    }
}

impl<const N: usize> Welch<N> {
    /// Averages segments of `length` samples, at least one, that overlap by half.
    #[must_use]
    pub fn new(length: usize) -> Self {
        let length = length.max(1);
        let fft = forward(length);
        let empty = fft.make_output_vec();
        Self {
            window: Window::default().weights(length),
            hop: (length / 2).max(1),
            detrend: Detrend::default(),
            input: vec![0.0; length],
            power: std::array::from_fn(|_| vec![0.0; empty.len()]),
            cross: std::array::from_fn(|_| empty.clone()),
            lines: std::array::from_fn(|_| empty.clone()),
            segments: 0,
            fft,
        }
    }

    /// Makes segments that do not overlap: they are independent, so that the distribution of their coherence is known.
    #[must_use]
    pub fn without_overlap(self) -> Self {
        Self { hop: self.length(), ..self }
    }

    /// Makes neighbouring segments overlap by this share of their length, 0 to below 1.
    #[must_use]
    pub fn with_overlap(self, share: f64) -> Self {
        let apart = (self.length() as f64 * (1.0 - share)).round() as usize;
        Self { hop: apart.clamp(1, self.length()), ..self }
    }

    /// Weights each segment by this window.
    #[must_use]
    pub fn with_window(self, window: Window) -> Self {
        Self { window: window.weights(self.length()), ..self }
    }

    /// Takes this off each segment.
    #[must_use]
    pub fn with_detrend(self, detrend: Detrend) -> Self {
        Self { detrend, ..self }
    }

    /// Factor by which the variance of a density grows because segments overlap, relative to as many independent segments: 1 plus twice
    /// the squared correlations of the windows of a segment and of all later ones (P. D. Welch, 1967, of many segments of white noise).
    fn variance_factor(&self) -> f64 {
        let product =
            |apart: usize| self.window.iter().zip(&self.window[apart..]).map(|(a, b)| a * b).sum::<f64>();
        let of_one = product(0);
        let others = (self.hop..self.length()).step_by(self.hop);
        1.0 + 2.0 * others.map(|apart| (product(apart) / of_one).powi(2)).sum::<f64>()
    }

    /// Number of samples of a segment.
    #[must_use]
    pub fn length(&self) -> usize {
        self.window.len()
    }

    /// Number of samples from the first of a segment to the first of the next.
    #[must_use]
    pub fn hop(&self) -> usize {
        self.hop
    }

    /// Adds all segments of signals without a gap, of equal length. Samples after the last whole segment are left out.
    pub fn add_run(&mut self, signals: [&[f64]; N]) {
        let rows = signals.iter().map(|signal| signal.len()).min().unwrap_or(0);
        let mut start = 0;
        while start + self.length() <= rows {
            self.add(signals.map(|signal| &signal[start..]));
            start += self.hop;
        }
    }

    /// Adds the segment at the beginning of the signals.
    pub fn add(&mut self, signals: [&[f64]; N]) {
        let length = self.length();
        let is_whole =
            |signal: &&[f64]| signal.len() >= length && signal[..length].iter().all(|v| v.is_finite());
        if !signals.iter().all(is_whole) {
            return;
        }
        for (signal, lines) in signals.iter().zip(&mut self.lines) {
            let signal = &signal[..length];
            let [mean, slope] = self.detrend.of(signal);
            let first = mean - 0.5 * slope * (length - 1) as f64;
            for (k, ((input, value), weight)) in
                self.input.iter_mut().zip(signal).zip(&self.window).enumerate()
            {
                *input = (value - first - slope * k as f64) * weight;
            }
            // The transform fails only for buffers of a wrong length, and these have the right length.
            if self.fft.process(&mut self.input, lines).is_err() {
                return;
            }
        }
        self.segments += 1;
        for signal in 0..N {
            for (line, value) in self.lines[signal].iter().enumerate() {
                self.power[signal][line] += value.norm_sqr();
                if signal > 0 {
                    self.cross[signal][line] += value * self.lines[0][line].conj();
                }
            }
        }
    }

    /// The average over all segments, of signals with this sample time in s; `None` without a segment. Clears the sums.
    pub fn finish(&mut self, sample_time_s: f64) -> Option<Spectra<N>> {
        let segments = std::mem::take(&mut self.segments);
        let empty = |sums: &Vec<f64>| vec![0.0; sums.len()];
        let power = std::array::from_fn(|signal| {
            let empty = empty(&self.power[signal]);
            std::mem::replace(&mut self.power[signal], empty)
        });
        let cross = std::array::from_fn(|signal| {
            let empty = vec![Complex::new(0.0, 0.0); self.cross[signal].len()];
            std::mem::replace(&mut self.cross[signal], empty)
        });
        let squares: f64 = self.window.iter().map(|weight| weight * weight).sum();
        let sum: f64 = self.window.iter().sum();
        (segments > 0).then(|| Spectra {
            step_hz: 1.0 / (sample_time_s * self.length() as f64),
            density_per_sum: 2.0 * sample_time_s / (squares * segments as f64),
            noise_lines: self.length() as f64 * squares / (sum * sum),
            variance_factor: self.variance_factor(),
            segments,
            power,
            cross,
        })
    }
}
