//! The noise of a measured input: how large it can be, and what it does to a fit.

use std::sync::Arc;

use faer::Mat;
use socam_model::{Channel, Model, Quantity, Take};
use socam_recording::Dataset;

use crate::{
    IdentifyError, Intersample, Options, Problem, StartState, feed,
    pass::{self, Colour, Point, StretchResult, Weights},
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

/// What a noisy input calls for at each sample time of the problem. Empty where no input is noisy, or where no steady filter
/// exists.
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
        let impulses = Arc::new(Impulses::new(problem.model, levels, whitener.memory, sample_time_s)?);
        colours.push(Colour { sample_time_s, whitener, impulses, bias: Vec::new() });
    }
    Ok(Arc::new(colours))
}

/// The same with what input noise adds to each sample's slope times residual.
pub(crate) fn with_biases(
    problem: &Problem<'_>,
    point: &Point,
    colours: Arc<Vec<Colour>>,
    units: &[f64],
) -> Result<Arc<Vec<Colour>>, IdentifyError> {
    let free = problem.free.len();
    let plain = Weights::white(units.to_vec(), vec![1.0; free]);
    let weights = Weights { colours: Arc::clone(&colours), ..plain };
    let mut known = Vec::new();
    for colour in colours.iter() {
        let gram = colour.impulses.gram(problem, point, &weights)?;
        let bias = gram.map_or_else(Vec::new, |gram| (0..free).map(|j| gram[(j, free)]).collect());
        known.push(Colour { bias, ..colour.clone() });
    }
    Ok(Arc::new(known))
}

/// The different sample times of a problem.
pub(crate) fn sample_times(problem: &Problem<'_>) -> Vec<f64> {
    let mut times: Vec<f64> = problem.stretches.iter().map(|stretch| stretch.sample_time_s).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// What input noise is expected to have of the products of [free parameters | residual] with each other, summed over all
/// samples; as scaled and weighted in a pass. `None` where the response overflowed.
///
/// The slopes and the residual hold the same noise. Less this, the sum of squared residuals has its minimum, on average,
/// at the truth; with it, beside that (Söderström, Automatica 43, 2007, on bias compensation).
pub(crate) fn excess(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    results: &[StretchResult],
) -> Result<Option<Mat<f64>>, IdentifyError> {
    let size = problem.free.len() + 1;
    let mut sum = Mat::zeros(size, size);
    for colour in weights.colours.iter() {
        let all = problem.stretches.iter().zip(results);
        let own = all.filter(|(stretch, _)| stretch.sample_time_s == colour.sample_time_s);
        let samples: f64 = own.map(|(_, result)| result.samples).sum();
        let Some(gram) = colour.impulses.gram(problem, point, weights)? else { return Ok(None) };
        sum += gram * faer::Scale(samples);
    }
    Ok(Some(sum))
}

/// Recordings in which one input jumps for one sample by its noise, and nothing was measured but zero.
#[derive(Debug)]
pub(crate) struct Impulses {
    model: Model,
    datasets: Vec<Dataset>,
    sample_time_s: f64,
}

impl Impulses {
    /// Followed until a filter with this memory has forgotten them.
    fn new(
        model: &Model,
        levels: &NoiseLevels,
        memory: f64,
        sample_time_s: f64,
    ) -> Result<Self, IdentifyError> {
        let model = linear(model);
        let rows = IMPULSE_ROW + (FADED.ln() / memory.ln()).clamp(64.0, LONGEST_ROWS) as usize;
        let noisy = levels.inputs.iter().enumerate().filter(|(_, std)| **std > 0.0);
        let datasets = noisy.map(|(input, std)| impulse(&model, input, *std, rows, sample_time_s));
        let datasets = datasets.collect::<Result<Vec<_>, _>>()?;
        Ok(Self { model, datasets, sample_time_s })
    }

    /// Products of whitened [slopes | residual] with each other over the response.
    fn gram(
        &self,
        problem: &Problem<'_>,
        point: &Point,
        weights: &Weights,
    ) -> Result<Option<Mat<f64>>, IdentifyError> {
        let stretches = self.datasets.iter().enumerate().map(|(recording, dataset)| feed::Stretch {
            recording,
            first_row: 0,
            rows: dataset.rows(),
            run: 0..dataset.rows(),
            amends: Arc::default(),
            sample_time_s: self.sample_time_s,
        });
        let twin = Problem {
            model: &self.model,
            datasets: &self.datasets,
            free: problem.free.clone(),
            stretches: stretches.collect(),
            options: Options { start_state: StartState::Free, ..problem.options.clone() },
            intersample: problem.intersample,
            warnings: Vec::new(),
            left_out: Vec::new(),
            misfits: Vec::new(),
        };
        let Ok(equations) = self.model.equations(&point.values) else { return Ok(None) };
        let at_rest = vec![0.0; equations.state.nrows()];
        let still = Point { values: point.values.clone(), locals: vec![at_rest; self.datasets.len()] };
        let weights = Weights { scores: false, probes: Arc::default(), ..weights.clone() };
        let Some(results) = pass::run(&twin, &still, &weights)? else { return Ok(None) };
        let size = problem.free.len() + 1;
        let mut gram = Mat::<f64>::zeros(size, size);
        for result in &results {
            let own = result.factor.as_ref().subcols(result.locals(), size);
            gram += own.transpose() * own;
        }
        Ok(Some(gram))
    }
}

/// The model without force laws, its channels in SI and each with a column of its own.
fn linear(model: &Model) -> Model {
    let mut model = model.clone();
    model.effects.clear();
    for (index, channel) in model.channels.iter_mut().enumerate() {
        (channel.scale, channel.offset, channel.estimate_offset) = (1.0, 0.0, false);
        (channel.take, channel.column) = (Take::Value, format!("channel_{index}_1"));
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
