//! From recordings to responses.

use socam_frequency::{
    Complex,
    response::{self, Line, Options},
};
use socam_model::{Equations, Model};
use socam_recording::Dataset;

use crate::answer::Answer;
use crate::error::Result;
use crate::prepare::prepared;
use crate::signals::{self, Pair, Segment};

/// Default band, Hz; it ends at a third of the sampling rate if that is lower.
const BAND_HZ: [f64; 2] = [0.1, 100.0];

/// How responses are estimated.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settings {
    /// Column of the reference signal, which is free of noise; `command_V` where it is not given and all recordings have that.
    pub reference: Option<String>,
    /// Lowest and highest frequency, Hz; 0.1 to 100, or to a third of the sampling rate if that is lower.
    pub band_hz: Option<[f64; 2]>,
    /// Period of the excitation, s; estimated where it is not given.
    pub period_s: Option<f64>,
    /// Standard deviations from the median of its neighbours beyond which a sample is replaced by that.
    pub outliers: Option<f64>,
    /// Corner in Hz and order of a Butterworth filter on all signals.
    pub low_pass: Option<(f64, usize)>,
    /// Whether of recordings with the same mean input only the one with least noise is used.
    pub quietest: bool,
}

/// Responses of the outputs of these names, or of all.
///
/// # Errors
/// [`ResponseError`](crate::ResponseError) where the model has another number of inputs than one, an output does not exist, a recording lacks a
/// channel, or the signals are too short or not excited.
pub fn estimate<'m>(
    model: &'m Model,
    datasets: &[Dataset],
    outputs: &[String],
    settings: &Settings,
) -> Result<Vec<Answer<'m>>> {
    let equations = model.equations(&model.values())?;
    let pairs = signals::pairs(model, outputs)?;
    pairs.into_iter().map(|pair| of_pair(&equations, pair, datasets, settings)).collect()
}

fn of_pair<'m>(
    equations: &Equations,
    pair: Pair<'m>,
    datasets: &[Dataset],
    settings: &Settings,
) -> Result<Answer<'m>> {
    let segments = signals::segments(datasets, &pair, settings.reference.as_deref())?;
    let warnings = signals::bias(&segments, &pair).into_iter().collect();
    let (segments, notes) = prepared(segments, settings)?;
    let rate_hz = segments.iter().map(|s| 1.0 / s.sample_time_s).fold(f64::INFINITY, f64::min);
    let band_hz = settings.band_hz.unwrap_or([BAND_HZ[0], BAND_HZ[1].min(rate_hz / 3.0)]);
    let options = Options { band_hz, period_s: settings.period_s };
    let signals: Vec<_> = segments.iter().map(Segment::signals).collect();
    let response = response::estimate(&signals, &options)?;
    let model = response.lines.iter().map(|line| of_model(equations, &pair, line)).collect();
    Ok(Answer { pair, response, model, warnings, notes })
}

fn of_model(equations: &Equations, pair: &Pair<'_>, line: &Line) -> Complex<f64> {
    let s = Complex::new(0.0, std::f64::consts::TAU * line.frequency_hz);
    equations.transfer(pair.output_index, pair.input_index, s).unwrap_or_default()
}
