//! The frequency response from sampled input and output, with confidence, and how much of the output is not linear.

mod distortion;

use std::ops::Range;

pub use crate::lines::{Line, apart};
use crate::{FrequencyError, local, periodic::Periodic, periods};
use distortion::distortion;
pub use distortion::{Distortion, Driven, OutputLine, Parity};

/// Lines over frequency where the recordings do not repeat.
const LINES: usize = 200;

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

#[cfg(test)]
mod tests;
