//! Estimates frequency responses from recordings.

use socam_frequency::{
    Complex,
    response::{self, Line, Options},
};
use socam_model::{Equations, Model};
use socam_recording::Dataset;

use crate::answer::{Answer, Measured};
use crate::error::Result;
use crate::prepare::prepared;
use crate::settings::Settings;
use crate::signals::{self, Pair, Segment, Signal};

/// Default band, Hz; it ends at a third of the sampling rate if that is lower.
const BAND_HZ: [f64; 2] = [0.1, 100.0];

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

/// The response of one column of recordings over another, the input. A column that the model reads is read as the model reads it, so that
/// this is what [`estimate`] gives for these two channels of a model with one input; other columns are taken as they are.
///
/// ```
/// use socam_model::Model;
/// use socam_recording::{Channel, Dataset, Unit};
/// use socam_response::{Settings, between};
///
/// let time_s: Vec<f64> = (0..4000).map(|k| 1e-3 * f64::from(k)).collect();
/// let input: Vec<f64> = time_s.iter().map(|t| (600.0 * t * t).sin()).collect();
/// let output = input.iter().map(|value| -3.0 * value).collect();
/// let channels = vec![Channel::new("a", Unit::V), Channel::new("b", Unit::V)];
/// let recording = Dataset::from_columns("chirp", channels, time_s, vec![input, output])?;
/// let model = Model::builtin("two-mass").expect("an embedded model");
/// let measured = between(&model, &[recording], ["a_V", "b_V"], &Settings::default())?;
/// assert!(measured.response.lines.iter().all(|line| (line.response.re + 3.0).abs() < 1e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ResponseError`](crate::ResponseError) where a recording lacks a column, the model takes a wave of one, or the signals are too short or
/// not excited.
pub fn between(
    model: &Model,
    datasets: &[Dataset],
    [input, output]: [&str; 2],
    settings: &Settings,
) -> Result<Measured> {
    let inputs = || model.inputs().filter(|channel| !channel.quantity.is_clock());
    let input = Signal::of_column(input, inputs().chain(model.outputs()));
    let output = Signal::of_column(output, model.outputs().chain(inputs()));
    measured([input, output], datasets, settings)
}

fn of_pair<'m>(
    equations: &Equations,
    pair: Pair<'m>,
    datasets: &[Dataset],
    settings: &Settings,
) -> Result<Answer<'m>> {
    let signals = [Signal::of(pair.input), Signal::of(pair.output)];
    let Measured { response, warnings, notes } = measured(signals, datasets, settings)?;
    let model = response.lines.iter().map(|line| of_model(equations, &pair, line)).collect();
    Ok(Answer { pair, response, model, warnings, notes })
}

fn measured(signals: [Signal<'_>; 2], datasets: &[Dataset], settings: &Settings) -> Result<Measured> {
    let segments = signals::segments(datasets, signals, settings.reference.as_deref())?;
    let warnings = signals::bias(&segments, signals[0]).into_iter().collect();
    let (segments, notes) = prepared(segments, settings)?;
    let rate_hz = segments.iter().map(|s| 1.0 / s.sample_time_s).fold(f64::INFINITY, f64::min);
    let band_hz = settings.band_hz.unwrap_or([BAND_HZ[0], BAND_HZ[1].min(rate_hz / 3.0)]);
    let options = Options { band_hz, period_s: settings.period_s };
    let signals: Vec<_> = segments.iter().map(Segment::signals).collect();
    Ok(Measured { response: response::estimate(&signals, &options)?, warnings, notes })
}

fn of_model(equations: &Equations, pair: &Pair<'_>, line: &Line) -> Complex<f64> {
    let s = Complex::new(0.0, std::f64::consts::TAU * line.frequency_hz);
    equations.transfer(pair.output_index, pair.input_index, s).unwrap_or_default()
}
