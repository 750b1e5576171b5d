//! The frequency response from sampled input and output, with confidence, and how much of the output is not linear.

use std::ops::Range;

use nalgebra::Complex;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

pub use crate::lines::{Line, apart};
use crate::{FrequencyError, local, periodic::Periodic, periods};

/// Lines over frequency where the recordings do not repeat.
const LINES: usize = 200;
/// Noise alone seems distorted so seldom.
const FALSE_ALARM: f64 = 1e-3;

/// Signals of one uninterrupted stretch of a recording.
#[derive(Debug, Clone, Copy)]
pub struct Signals<'a> {
    /// What drives the bench, as measured.
    pub input: &'a [f64],
    /// What it answers, as long.
    pub output: &'a [f64],
    /// What made the input, if that is known without noise (a command).
    pub reference: Option<&'a [f64]>,
    /// Step between samples, s.
    pub sample_time_s: f64,
}

/// How a response is estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Lowest and highest frequency, Hz.
    pub band_hz: [f64; 2],
    /// Period of the excitation, s; found from the signals where it is not given.
    pub period_s: Option<f64>,
}

/// How it was estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// The signals repeat: their lines stand apart from noise.
    Periodic {
        /// Period, s.
        period_s: f64,
        /// Periods used, of all stretches.
        periods: usize,
    },
    /// They do not: local polynomials.
    Local,
}

/// A frequency response.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// How it was estimated.
    pub method: Method,
    /// Over rising frequency.
    pub lines: Vec<Line>,
    /// What the lines that nothing drives say; only of periodic signals that leave lines out.
    pub distortion: Option<Distortion>,
}

/// Power where nothing drives the bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Distortion {
    /// Even multiples of the base frequency.
    pub even: Option<Parity>,
    /// Odd ones.
    pub odd: Option<Parity>,
    /// All lines of the output.
    pub lines: Vec<OutputLine>,
}

/// Lines of one parity that nothing drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parity {
    /// How many.
    pub lines: usize,
    /// Root mean square of distortion per line over that of the output's driven lines, noise taken off, dB.
    pub level_db: Option<f64>,
    /// The same of noise.
    pub noise_db: f64,
    /// Mean power over what noise alone leaves.
    pub over_noise: f64,
    /// Probability that noise alone reaches that.
    pub p_value: f64,
    /// Whether it is too much for noise.
    pub significant: bool,
}

/// What a line of the output is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Driven {
    /// The input drives it.
    Excited,
    /// It is an even multiple that nothing drives.
    Even,
    /// An odd one.
    Odd,
}

/// A line of the output's spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputLine {
    /// Hz.
    pub frequency_hz: f64,
    /// What it is.
    pub driven: Driven,
    /// Amplitude; where nothing drives it, of what the input's remainder does not explain.
    pub amplitude: f64,
    /// Standard deviation that noise gives it.
    pub noise: f64,
}

/// Estimates the response of `output` to `input` over all stretches together.
///
/// Signals that repeat (all of them, with one period) answer at the lines that the input drives; others on a logarithmic grid.
/// Assumes a bench that is linear and the same throughout. Breaks where the input is measured with noise and neither repeats
/// nor has a reference: then the response is too small by the input's share of noise.
///
/// # Errors
/// [`FrequencyError`] where stretches are too short, or nothing drives the bench within the band.
pub fn estimate(signals: &[Signals<'_>], options: &Options) -> Result<Response, FrequencyError> {
    for stretch in signals {
        let (input, output) = (stretch.input.len(), stretch.output.len());
        if input != output || stretch.reference.is_some_and(|reference| reference.len() != input) {
            return Err(FrequencyError::Lengths { input, output });
        }
    }
    let rows = signals.iter().map(|s| s.input.len()).max().unwrap_or(0);
    if rows < local::SHORTEST {
        return Err(FrequencyError::TooShort { rows, needed: local::SHORTEST });
    }
    let response = repeating(signals, options).unwrap_or_else(|| flowing(signals, options));
    if response.lines.is_empty() {
        let [from_hz, to_hz] = options.band_hz;
        return Err(FrequencyError::NotExcited { from_hz, to_hz });
    }
    Ok(response)
}

/// A stretch's whole periods, in samples.
struct Whole<'a> {
    signals: Signals<'a>,
    rows: Range<usize>,
    period: usize,
}

impl Whole<'_> {
    fn count(&self) -> usize {
        self.rows.len() / self.period
    }

    fn record(&self) -> Periodic {
        let cut = |values: &[f64]| values[self.rows.clone()].to_vec();
        let reference = self.signals.reference.map(cut);
        Periodic::new(
            &cut(self.signals.input),
            &cut(self.signals.output),
            self.count(),
            self.signals.sample_time_s,
            reference.as_deref(),
        )
    }
}

/// Where every stretch repeats: the response at the lines.
fn repeating(signals: &[Signals<'_>], options: &Options) -> Option<Response> {
    let wholes: Vec<Whole<'_>> =
        signals.iter().map(|s| whole(*s, options.period_s)).collect::<Option<_>>()?;
    let period_s = wholes.first()?.period as f64 * wholes.first()?.signals.sample_time_s;
    let same = |w: &Whole<'_>| (w.period as f64 * w.signals.sample_time_s / period_s - 1.0).abs() < 1e-4;
    if !wholes.iter().all(same) {
        return None;
    }
    let records: Vec<Periodic> = wholes.iter().map(Whole::record).collect();
    let [from_hz, to_hz] = options.band_hz;
    let mut lines: Vec<Line> = Vec::new();
    let mut all: Vec<Line> = records.iter().flat_map(Periodic::lines).collect();
    all.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    for line in all.into_iter().filter(|line| (from_hz..=to_hz).contains(&line.frequency_hz)) {
        match lines.last_mut() {
            Some(last) if (last.frequency_hz * period_s - line.frequency_hz * period_s).abs() < 0.5 => {
                *last = last.joined(line);
            }
            _ => lines.push(line),
        }
    }
    let periods = wholes.iter().map(Whole::count).sum();
    let distortion = distortion(&records, &lines, to_hz);
    Some(Response { method: Method::Periodic { period_s, periods }, lines, distortion })
}

fn whole(signals: Signals<'_>, period_s: Option<f64>) -> Option<Whole<'_>> {
    let clean = signals.reference.unwrap_or(signals.input);
    let period = match period_s {
        Some(period_s) => (period_s / signals.sample_time_s).round() as usize,
        None => periods::period(clean)?,
    };
    let rows = periods::steady(clean, period.max(1));
    // What is cut off where the command's own course changes must be cut off the answer, too, so nothing else is looked at.
    (period > 1 && rows.len() >= 2 * period).then_some(Whole { signals, rows, period })
}

fn flowing(signals: &[Signals<'_>], options: &Options) -> Response {
    let long = signals.iter().filter(|s| s.input.len() >= local::SHORTEST);
    let stretches: Vec<local::Stretch> =
        long.map(|s| local::Stretch::new(s.input, s.output, s.reference, s.sample_time_s)).collect();
    let lowest = stretches.iter().map(local::Stretch::lowest_hz).fold(f64::INFINITY, f64::min);
    let (from, to) = (options.band_hz[0].max(lowest).ln(), options.band_hz[1].ln());
    let grid = (0..LINES).map(|i| (from + (to - from) * i as f64 / (LINES - 1) as f64).exp());
    let lines = grid.filter_map(|frequency_hz| local::line(&stretches, frequency_hz)).collect();
    Response { method: Method::Local, lines, distortion: None }
}

/// Response between two lines, along straight lines of its real and imaginary part; beyond the ends, that of the end.
fn between(lines: &[Line], frequency_hz: f64) -> Complex<f64> {
    let after = lines.partition_point(|line| line.frequency_hz < frequency_hz);
    let (Some(low), Some(high)) = (lines.get(after.saturating_sub(1)), lines.get(after.min(lines.len() - 1)))
    else {
        return Complex::default();
    };
    let span = high.frequency_hz - low.frequency_hz;
    let share = if span > 0.0 { ((frequency_hz - low.frequency_hz) / span).clamp(0.0, 1.0) } else { 0.0 };
    low.response * (1.0 - share) + high.response * share
}

fn distortion(records: &[Periodic], lines: &[Line], to_hz: f64) -> Option<Distortion> {
    if lines.is_empty() {
        return None;
    }
    let mut output = Vec::new();
    let mut freedom = 0.0_f64;
    for record in records {
        for harmonic in record.harmonics.iter().filter(|h| h.frequency_hz <= to_hz) {
            let even = harmonic.order.is_multiple_of(2);
            let (driven, value) = if harmonic.excited {
                (Driven::Excited, harmonic.output)
            } else {
                let rest = record.error(harmonic, between(lines, harmonic.frequency_hz));
                (if even { Driven::Even } else { Driven::Odd }, rest)
            };
            freedom = harmonic.freedom;
            let scale = 2.0 / record.samples() as f64;
            output.push(OutputLine {
                frequency_hz: harmonic.frequency_hz,
                driven,
                amplitude: scale * value.value.norm(),
                noise: scale * value.variance.sqrt(),
            });
        }
    }
    let power = |driven: Driven| {
        let own: Vec<&OutputLine> = output.iter().filter(|line| line.driven == driven).collect();
        let sum = |of: &dyn Fn(&OutputLine) -> f64| own.iter().map(|line| of(line)).sum::<f64>();
        (
            own.len(),
            sum(&|l| l.amplitude.powi(2)),
            sum(&|l| l.noise.powi(2)),
            sum(&|l| (l.amplitude / l.noise).powi(2)),
        )
    };
    let (count, driven_power, ..) = power(Driven::Excited);
    let reference = driven_power / count.max(1) as f64;
    let decibel = |power: f64| 10.0 * (power / reference).log10();
    let parity = |driven: Driven| {
        let (lines, total, noise, ratios) = power(driven);
        if lines == 0 || noise <= 0.0 {
            return None;
        }
        let over_noise = ratios / lines as f64;
        // Neighbouring lines share most of the bins that their noise is estimated from.
        let shared = (freedom * lines as f64 / 4.0).max(freedom);
        let p_value = FisherSnedecor::new(2.0 * lines as f64, 2.0 * shared).map_or(1.0, |f| f.sf(over_noise));
        let own = total - noise;
        let significant = p_value < FALSE_ALARM;
        Some(Parity {
            lines,
            level_db: (own > 0.0 && significant).then(|| decibel(own / lines as f64)),
            noise_db: decibel(noise / lines as f64),
            over_noise,
            p_value,
            significant,
        })
    };
    let (even, odd) = (parity(Driven::Even), parity(Driven::Odd));
    (even.is_some() || odd.is_some()).then_some(Distortion { even, odd, lines: output })
}

#[cfg(test)]
mod tests;
