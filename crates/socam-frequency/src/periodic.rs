//! Lines of a periodic signal. The bins between them hold noise and transients, which are interpolated to the lines by local
//! polynomials (the fast method of Pintelon, Barbe, Vandersteen and Schoukens).
//!
//! Input and output are treated in the same way, so that noise of the input does not bias the response, as a ratio of power spectra would.

use nalgebra::{Complex, Matrix3, Vector3};
use socam_spectrum::transform;

use crate::lines::Line;

type C = Complex<f64>;

/// Number of bins between lines from which the noise of a line is estimated: 14 less 3 coefficients leave 11 degrees of freedom.
const BINS: usize = 14;
/// A line is excited if its power is at least this share of the strongest within four lines of it.
const EXCITED: f64 = 0.01;
/// Least ratio of the power of an excited line to that of its noise.
const OVER_NOISE: f64 = 20.0;

/// One signal at one multiple of the base frequency.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Value {
    /// The periodic part.
    pub(crate) value: C,
    /// Mean square of its error.
    pub(crate) variance: f64,
    /// Mean square of noise in one bin.
    noise: f64,
}

/// Both signals at one multiple of the base frequency.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Harmonic {
    pub(crate) order: usize,
    pub(crate) frequency_hz: f64,
    pub(crate) input: Value,
    pub(crate) output: Value,
    pub(crate) excited: bool,
    pub(crate) freedom: f64,
    bins: Window,
}

/// The bins from which the noise of a line is estimated.
#[derive(Debug, Clone, Copy)]
struct Window {
    first: usize,
    count: usize,
}

/// A record of whole periods.
pub(crate) struct Periodic {
    pub(crate) harmonics: Vec<Harmonic>,
    periods: usize,
    samples: usize,
    input: Vec<C>,
    output: Vec<C>,
}

impl Periodic {
    /// `input` and `output` hold `periods` whole periods, two or more. `reference` says which lines are driven.
    pub(crate) fn new(
        input: &[f64],
        output: &[f64],
        periods: usize,
        sample_time_s: f64,
        reference: Option<&[f64]>,
    ) -> Self {
        let length = input.len();
        let mut record = Self {
            harmonics: Vec::new(),
            periods,
            samples: length,
            input: transform(input),
            output: transform(output),
        };
        let step_hz = 1.0 / (length as f64 * sample_time_s);
        let last = (record.input.len() - 1) / periods;
        for order in 1..=last {
            let Some((window, bins)) = record.window(order * periods) else { continue };
            let at = order * periods;
            record.harmonics.push(Harmonic {
                order,
                frequency_hz: at as f64 * step_hz,
                input: value(&record.input, at, &bins),
                output: value(&record.output, at, &bins),
                excited: false,
                freedom: (bins.len() - 3) as f64,
                bins: window,
            });
        }
        record.mark_excited(reference);
        record
    }

    /// Bins near `at` that belong to no line.
    fn window(&self, at: usize) -> Option<(Window, Vec<usize>)> {
        let free = |bin: &usize| *bin > 0 && *bin < self.input.len() && !bin.is_multiple_of(self.periods);
        let mut reach = 1;
        loop {
            let (first, last) = (at.saturating_sub(reach), at + reach);
            let bins: Vec<usize> = (first..=last).filter(free).collect();
            if bins.len() >= BINS {
                return Some((Window { first, count: last - first + 1 }, bins));
            }
            if reach > self.input.len() {
                return None;
            }
            reach += 1;
        }
    }

    fn bins(&self, window: Window) -> Vec<usize> {
        (window.first..window.first + window.count)
            .filter(|bin| *bin > 0 && *bin < self.input.len() && !bin.is_multiple_of(self.periods))
            .collect()
    }

    fn mark_excited(&mut self, reference: Option<&[f64]>) {
        let known = reference.map(transform);
        let power: Vec<f64> = self
            .harmonics
            .iter()
            .map(|h| match &known {
                Some(lines) => lines.get(h.order * self.periods).map_or(0.0, C::norm_sqr),
                None => h.input.value.norm_sqr(),
            })
            .collect();
        for index in 0..self.harmonics.len() {
            let near = &power[index.saturating_sub(4)..(index + 5).min(power.len())];
            let strongest = near.iter().copied().fold(0.0, f64::max);
            let input = self.harmonics[index].input;
            self.harmonics[index].excited =
                power[index] > EXCITED * strongest && input.value.norm_sqr() > OVER_NOISE * input.variance;
        }
    }

    /// Samples of either signal.
    pub(crate) fn samples(&self) -> usize {
        self.samples
    }

    /// Response at the excited lines.
    pub(crate) fn lines(&self) -> Vec<Line> {
        self.harmonics.iter().filter(|h| h.excited).map(|h| self.line(h)).collect()
    }

    fn line(&self, harmonic: &Harmonic) -> Line {
        let response = harmonic.output.value / harmonic.input.value;
        let error = self.error(harmonic, response);
        let coherence = share(harmonic.input, self.periods) * share(harmonic.output, self.periods);
        Line {
            frequency_hz: harmonic.frequency_hz,
            response,
            variance: error.variance / harmonic.input.value.norm_sqr(),
            freedom: harmonic.freedom,
            width_hz: 0.0,
            coherence,
        }
    }

    /// Output less `response` times input at a harmonic, with its noise, including the covariance of both noises.
    pub(crate) fn error(&self, harmonic: &Harmonic, response: C) -> Value {
        let bins = self.bins(harmonic.bins);
        let at = harmonic.order * self.periods;
        let first = harmonic.bins.first.min(at);
        let last = (harmonic.bins.first + harmonic.bins.count).min(self.input.len());
        let rest: Vec<C> = (first..last).map(|bin| self.output[bin] - response * self.input[bin]).collect();
        let shifted: Vec<usize> = bins.iter().map(|bin| bin - first).collect();
        value(&rest, at - first, &shifted)
    }
}

/// Share of signal in the power of one period.
fn share(value: Value, periods: usize) -> f64 {
    let signal = (value.value.norm_sqr() - value.variance).max(0.0) / periods as f64;
    if signal > 0.0 { signal / (signal + value.noise) } else { 0.0 }
}

/// The part of bin `at` that the bins around it do not predict.
fn value(spectrum: &[C], at: usize, bins: &[usize]) -> Value {
    let reach = bins.iter().map(|bin| bin.abs_diff(at)).max().unwrap_or(1) as f64;
    let row = |bin: usize| {
        let x = (bin as f64 - at as f64) / reach;
        Vector3::new(1.0, x, x * x)
    };
    let normal: Matrix3<f64> = bins.iter().map(|bin| row(*bin) * row(*bin).transpose()).sum();
    let inverse = normal.try_inverse().unwrap_or_else(Matrix3::zeros);
    let moments = bins.iter().fold([C::default(); 3], |mut sum, bin| {
        let row = row(*bin);
        (0..3).for_each(|i| sum[i] += spectrum[*bin] * row[i]);
        sum
    });
    let coefficient = |i: usize| (0..3).fold(C::default(), |sum, j| sum + moments[j] * inverse[(i, j)]);
    let coefficients = [coefficient(0), coefficient(1), coefficient(2)];
    let residual = |bin: &usize| {
        let row = row(*bin);
        (spectrum[*bin] - (0..3).fold(C::default(), |sum, i| sum + coefficients[i] * row[i])).norm_sqr()
    };
    let noise = bins.iter().map(residual).sum::<f64>() / (bins.len() - 3).max(1) as f64;
    Value { value: spectrum[at] - coefficients[0], variance: noise * (1.0 + inverse[(0, 0)]), noise }
}
