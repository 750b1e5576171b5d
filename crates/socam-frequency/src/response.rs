//! Frequency response from sampled input and output, with confidence and distortion.

mod distortion;

use std::ops::Range;

pub use crate::lines::{Line, apart};
use crate::{FrequencyError, local, periodic::Periodic, periods};
use distortion::distortion;
pub use distortion::{Distortion, Driven, OutputLine, Parity};

/// Number of lines if the recordings are not periodic.
const LINES: usize = 200;

/// Signals of one segment of a recording, without gaps.
#[derive(Debug, Clone, Copy)]
pub struct Signals<'a> {
    /// Measured input.
    pub input: &'a [f64],
    /// Measured output, of the same length.
    pub output: &'a [f64],
    /// Reference signal (a command) that is free of noise, if known.
    pub reference: Option<&'a [f64]>,
    /// Step between samples, s.
    pub sample_time_s: f64,
}

/// Options of the estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Lowest and highest frequency, Hz.
    pub band_hz: [f64; 2],
    /// Period of the excitation, s; estimated from the signals if not given.
    pub period_s: Option<f64>,
}

/// Method of estimation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// The signals are periodic: lines are separate from noise.
    Periodic {
        /// Period, s.
        period_s: f64,
        /// Number of periods in use, of all segments.
        periods: usize,
    },
    /// The signals are not periodic: local polynomials.
    Local,
}

/// A frequency response.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Method of estimation.
    pub method: Method,
    /// Over rising frequency.
    pub lines: Vec<Line>,
    /// Distortion at lines that are not excited; only for periodic signals with such lines.
    pub distortion: Option<Distortion>,
}

/// Estimates the response of `output` to `input` from all segments together.
///
/// If all signals are periodic with one period, lines are those that the input excites; otherwise they are on a logarithmic grid.
/// Assumes a linear, time-invariant bench. If the input has noise and is neither periodic nor has a reference, the response is biased
/// towards zero by the noise share of the input.
///
/// # Errors
/// [`FrequencyError`] if segments are too short, or if there is no excitation within the band.
pub fn estimate(signals: &[Signals<'_>], options: &Options) -> Result<Response, FrequencyError> {
    for segment in signals {
        let (input, output) = (segment.input.len(), segment.output.len());
        if input != output || segment.reference.is_some_and(|reference| reference.len() != input) {
            return Err(FrequencyError::Lengths { input, output });
        }
    }
    let rows = signals.iter().map(|s| s.input.len()).max().unwrap_or(0);
    if rows < local::SHORTEST {
        return Err(FrequencyError::TooShort { rows, needed: local::SHORTEST });
    }
    let response = at_lines(signals, options).unwrap_or_else(|| on_grid(signals, options));
    if response.lines.is_empty() {
        let [from_hz, to_hz] = options.band_hz;
        return Err(FrequencyError::NotExcited { from_hz, to_hz });
    }
    Ok(response)
}

/// The whole periods of a segment, in samples.
struct WholePeriods<'a> {
    signals: Signals<'a>,
    rows: Range<usize>,
    period: usize,
}

impl WholePeriods<'_> {
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

/// The response at the excited lines; `None` if a segment is not periodic.
fn at_lines(signals: &[Signals<'_>], options: &Options) -> Option<Response> {
    let wholes: Vec<WholePeriods<'_>> =
        signals.iter().map(|s| whole(*s, options.period_s)).collect::<Option<_>>()?;
    let period_s = wholes.first()?.period as f64 * wholes.first()?.signals.sample_time_s;
    let same =
        |w: &WholePeriods<'_>| (w.period as f64 * w.signals.sample_time_s / period_s - 1.0).abs() < 1e-4;
    if !wholes.iter().all(same) {
        return None;
    }
    let records: Vec<Periodic> = wholes.iter().map(WholePeriods::record).collect();
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
    let periods = wholes.iter().map(WholePeriods::count).sum();
    let distortion = distortion(&records, &lines, to_hz);
    Some(Response { method: Method::Periodic { period_s, periods }, lines, distortion })
}

fn whole(signals: Signals<'_>, period_s: Option<f64>) -> Option<WholePeriods<'_>> {
    let clean = signals.reference.unwrap_or(signals.input);
    let period = match period_s {
        Some(period_s) => (period_s / signals.sample_time_s).round() as usize,
        None => periods::period(clean)?,
    };
    let rows = periods::steady(clean, period.max(1));
    // The steady periods are those of the command; the same rows are used of the output.
    (period > 1 && rows.len() >= 2 * period).then_some(WholePeriods { signals, rows, period })
}

fn on_grid(signals: &[Signals<'_>], options: &Options) -> Response {
    let long = signals.iter().filter(|s| s.input.len() >= local::SHORTEST);
    let segments: Vec<local::Segment> =
        long.map(|s| local::Segment::new(s.input, s.output, s.reference, s.sample_time_s)).collect();
    let lowest = segments.iter().map(local::Segment::lowest_hz).fold(f64::INFINITY, f64::min);
    let (from, to) = (options.band_hz[0].max(lowest).ln(), options.band_hz[1].ln());
    let grid = (0..LINES).map(|i| (from + (to - from) * i as f64 / (LINES - 1) as f64).exp());
    let lines = grid.filter_map(|frequency_hz| local::line(&segments, frequency_hz)).collect();
    Response { method: Method::Local, lines, distortion: None }
}

#[cfg(test)]
mod tests;
