//! The noise of a measured input: how large it can be, and what it does to a fit.

use std::sync::Arc;

use faer::Mat;
use socam_model::{Channel, Model, Quantity};
use socam_recording::Dataset;

use crate::{
    IdentifyError, Intersample, Options, Problem, StartState, feed,
    pass::{self, Colour, Point, Weights},
    whitener::{NoiseLevels, Whitener},
};

/// Order of the differences that leave an input's noise and not its motion.
const DIFFERENCES: usize = 8;
/// Variance of white noise after them, binomial(16, 8).
const DIFFERENCED: f64 = 12_870.0;
/// Rows of a window over which differences are averaged.
const WINDOW: usize = 64;
/// The median of windows lies below the mean, and neither is exact.
const MARGIN: f64 = 1.1;
/// Rows and stretches that are looked at.
const MOST_ROWS: u64 = 32_768;
const MOST_STRETCHES: usize = 8;
/// Row of the impulse whose response shows what a sample's noise does.
const IMPULSE_ROW: usize = 8;
/// The response is followed until it has fallen to this fraction.
const FADED: f64 = 1e-8;
/// It is followed no longer than this.
const LONGEST_ROWS: f64 = 65_536.0;

/// Whether a channel drives the model by what a sensor said of a motion.
pub(crate) fn is_measured(channel: &Channel) -> bool {
    channel.quantity == Quantity::Speed
}

/// Most noise that each input can hold, SI: what its highest frequencies hold, were they noise alone. Zero for an input
/// that is not measured.
pub(crate) fn most(problem: &Problem<'_>) -> Result<Vec<f64>, IdentifyError> {
    let inputs: Vec<&Channel> = problem.model.inputs().collect();
    let mut windows: Vec<Vec<f64>> = vec![Vec::new(); inputs.len()];
    for stretch in problem.stretches.iter().take(MOST_STRETCHES) {
        let head = feed::Stretch { rows: stretch.rows.min(MOST_ROWS), ..stretch.clone() };
        let dataset = &problem.datasets[stretch.recording];
        feed::read(problem.model, dataset, &head, Intersample::Linear, |chunk| {
            for (input, windows) in chunk.inputs.iter().zip(&mut windows) {
                windows.extend(input.chunks_exact(WINDOW).map(differenced));
            }
        })?;
    }
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).map_or(0.0, |variance| MARGIN * variance.sqrt())
    };
    let each = windows.into_iter().zip(inputs);
    Ok(each.map(|(windows, channel)| if is_measured(channel) { median(windows) } else { 0.0 }).collect())
}

/// Variance of white noise that would leave differences of this size.
fn differenced(window: &[f64]) -> f64 {
    let mut values = window.to_vec();
    for _ in 0..DIFFERENCES {
        values = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    values.iter().map(|v| v * v).sum::<f64>() / (values.len() as f64 * DIFFERENCED)
}

/// Filters, and biases of the slopes, for each sample time of the problem. Empty where no input is noisy, or where no steady
/// filter exists.
pub(crate) fn colours(
    problem: &Problem<'_>,
    point: &Point,
    levels: &NoiseLevels,
    units: &[f64],
) -> Result<Arc<Vec<Colour>>, IdentifyError> {
    if !levels.in_the_input() {
        return Ok(Arc::default());
    }
    let Ok(equations) = problem.model.equations(&point.values) else { return Ok(Arc::default()) };
    let mut colours = Vec::new();
    for sample_time_s in sample_times(problem) {
        let Some(whitener) = Whitener::new(&equations, levels, units, sample_time_s) else {
            return Ok(Arc::default());
        };
        let at: Vec<f64> = problem.free.iter().map(|index| point.values[*index]).collect();
        let mut colour = Colour { sample_time_s, whitener, bias: vec![0.0; at.len()], at };
        colour.bias = bias_per_sample(problem, point, levels, units, &colour)?;
        colours.push(colour);
    }
    Ok(Arc::new(colours))
}

/// The different sample times of a problem.
pub(crate) fn sample_times(problem: &Problem<'_>) -> Vec<f64> {
    let mut times: Vec<f64> = problem.stretches.iter().map(|stretch| stretch.sample_time_s).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// Expected value per sample of whitened slope times whitened residual: both hold the same input noise. By the response to one
/// impulse of that noise's size.
///
/// The sum of squared whitened residuals has its minimum where the slopes are those of the *true* input; a fit that takes them
/// from the measured one must take this off (Söderström, Automatica 43, 2007, calls it bias compensation).
fn bias_per_sample(
    problem: &Problem<'_>,
    point: &Point,
    levels: &NoiseLevels,
    units: &[f64],
    colour: &Colour,
) -> Result<Vec<f64>, IdentifyError> {
    let model = linear(problem.model);
    let rows = IMPULSE_ROW + (FADED.ln() / colour.whitener.memory.ln()).clamp(64.0, LONGEST_ROWS) as usize;
    let noisy = levels.inputs.iter().enumerate().filter(|(_, std)| **std > 0.0);
    let datasets = noisy
        .map(|(input, std)| impulse(&model, input, *std, rows, colour.sample_time_s))
        .collect::<Result<Vec<_>, _>>()?;
    let stretches = (0..datasets.len()).map(|recording| feed::Stretch {
        recording,
        first_row: 0,
        rows: rows as u64,
        run: 0..rows as u64,
        sample_time_s: colour.sample_time_s,
    });
    let twin = Problem {
        model: &model,
        datasets: &datasets,
        free: problem.free.clone(),
        stretches: stretches.collect(),
        options: Options { start_state: StartState::Free, ..problem.options.clone() },
        intersample: problem.intersample,
        warnings: Vec::new(),
    };
    let states = model.equations(&point.values)?.state.nrows();
    let still = Point { values: point.values.clone(), locals: vec![vec![0.0; states]; datasets.len()] };
    let mut weights = Weights::white(units.to_vec(), vec![1.0; problem.free.len()]);
    weights.colours = Arc::new(vec![colour.clone()]);
    let results = pass::run(&twin, &still, &weights)?.unwrap_or_default();
    let mut bias = vec![0.0; problem.free.len()];
    for result in &results {
        let (locals, last) = (result.locals(), result.factor.ncols() - 1);
        let product = |a: usize, b: usize| dot(&result.factor, a, b);
        bias.iter_mut().enumerate().for_each(|(j, bias)| *bias += product(locals + j, last));
    }
    Ok(bias)
}

fn dot(matrix: &Mat<f64>, a: usize, b: usize) -> f64 {
    (0..matrix.nrows()).map(|i| matrix[(i, a)] * matrix[(i, b)]).sum()
}

/// The model without force laws and with its channels in SI.
fn linear(model: &Model) -> Model {
    let mut model = model.clone();
    model.effects.clear();
    for channel in &mut model.channels {
        (channel.scale, channel.offset, channel.estimate_offset) = (1.0, 0.0, false);
    }
    model
}

/// A recording in which one input jumps for one sample and nothing was measured but zero.
fn impulse(
    model: &Model,
    input: usize,
    size: f64,
    rows: usize,
    sample_time_s: f64,
) -> Result<Dataset, IdentifyError> {
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    let inputs = model.inputs().enumerate().map(|(i, channel)| (channel, i == input));
    for (channel, driven) in inputs.chain(model.outputs().map(|channel| (channel, false))) {
        let mut values = vec![0.0; rows];
        if driven {
            values[IMPULSE_ROW] = size;
        }
        columns.push((channel.column.clone(), values));
    }
    let time_s = (0..rows).map(|k| k as f64 * sample_time_s).collect();
    let named = columns
        .into_iter()
        .filter_map(|(column, values)| Some((socam_recording::Channel::from_column_name(&column)?, values)));
    let (channels, values) = named.unzip();
    Ok(Dataset::from_columns("impulse", channels, time_s, values)?)
}
