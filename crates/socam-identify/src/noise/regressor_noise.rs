//! Regressor-noise bias of the information matrix.
//!
//! Where an input is noisy, sensitivities are computed from measured signals: the noise adds to their products although it has no
//! information about the parameters. Its expected contribution is the sum of the squared responses of the sensitivities to a unit noise
//! impulse in each noisy channel.

use std::sync::Arc;

use faer::Mat;
use socam_model::{Channel, ChannelTransform, Model};
use socam_recording::Dataset;

use crate::{
    IdentifyError, Options, Problem, StartState,
    evaluation::{self, Point, SegmentEvaluation, Weights},
    matrix::gram,
    noise::{innovations_filter::InnovationsFilter, matrix_equations::spectral_radius},
    preprocessing::segments,
    problem::sample_times,
};

/// Row of the impulse in the artificial recording.
const IMPULSE_ROW: usize = 32;
/// The response is computed until it has decayed to this fraction.
const FADED: f64 = 1e-5;
/// Least and greatest number of rows of the response.
const ROWS: (f64, f64) = (64.0, 16_384.0);

/// Expected contribution of noise to the products of sensitivities, summed over all samples: free parameters x free parameters, in the
/// scale and weights of an evaluation. Zero if no input is noisy.
pub(crate) fn products(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    results: &[SegmentEvaluation],
) -> Result<Mat<f64>, IdentifyError> {
    let free = problem.free.len();
    let mut sum = Mat::zeros(free, free);
    if !weights.levels().in_the_input() {
        return Ok(sum);
    }
    for sample_time_s in sample_times(problem) {
        let all = problem.segments.iter().zip(results);
        let own = all.filter(|(segment, _)| segment.sample_time_s == sample_time_s);
        let samples: f64 = own.map(|(_, result)| result.samples).sum();
        if let Some(products) = per_sample(problem, point, weights, sample_time_s)? {
            sum += products * faer::Scale(samples);
        }
    }
    Ok(sum)
}

fn per_sample(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    sample_time_s: f64,
) -> Result<Option<Mat<f64>>, IdentifyError> {
    let model = linear(problem.model);
    let Ok(equations) = model.equations(&point.values) else { return Ok(None) };
    let levels = weights.levels();
    let Some(filter) =
        InnovationsFilter::new(&equations, &levels, &levels.outputs, sample_time_s, &problem.intersample)
    else {
        return Ok(None);
    };
    let plant = spectral_radius((&equations.state * sample_time_s).exp());
    let slowest =
        if plant < 1.0 - 1e-6 { filter.spectral_radius().max(plant) } else { filter.spectral_radius() };
    let rows = IMPULSE_ROW + (FADED.ln() / slowest.ln()).clamp(ROWS.0, ROWS.1) as usize;
    let sizes = levels.inputs.iter().chain(&levels.outputs).enumerate().filter(|(_, std)| **std > 0.0);
    let datasets = sizes.map(|(channel, std)| impulse(&model, channel, *std, rows, sample_time_s));
    let datasets = datasets.collect::<Result<Vec<_>, _>>()?;
    let segments = datasets.iter().enumerate().map(|(recording, dataset)| segments::Segment {
        recording,
        first_row: 0,
        rows: dataset.rows(),
        uninterrupted: 0..dataset.rows(),
        mask: Arc::default(),
        sample_time_s,
        longest_step_s: None,
        origin_s: 0.0,
    });
    let impulses = Problem::of_segments(
        (&model, &datasets),
        problem.free.clone(),
        segments.collect(),
        Options { start_state: StartState::Free, ..problem.options.clone() },
        problem.intersample.clone(),
    );
    let at_rest = vec![0.0; equations.state.nrows()];
    let still = Point { values: point.values.clone(), nuisance: vec![at_rest; datasets.len()] };
    let weights = Weights { scores: false, ..weights.clone() };
    let Some(results) = evaluation::run(&impulses, &still, &weights)? else { return Ok(None) };
    let free = problem.free.len();
    let mut products = Mat::<f64>::zeros(free, free);
    for result in &results {
        let own = result.factor.as_ref().subcols(result.nuisance(), free);
        products += gram(own);
    }
    Ok(Some(products))
}

/// The model without force laws, with channels in SI that have one column each. Rates stay rates; other transforms are left out.
fn linear(model: &Model) -> Model {
    let mut model = model.clone();
    model.effects.retain(|used| used.effect.laws().is_empty());
    for (index, channel) in model.channels.iter_mut().enumerate() {
        (channel.scale, channel.offset, channel.estimate_offset) = (1.0, 0.0, false);
        channel.column = format!("channel_{index}_1");
        channel.transform = if channel.transform == ChannelTransform::Rate {
            ChannelTransform::Rate
        } else {
            ChannelTransform::Value
        };
    }
    model
}

/// A recording in which one channel (inputs are counted first) has an impulse of one sample and all others are zero. The impulse makes
/// noise of standard deviation `size` in the channel.
fn impulse(
    model: &Model,
    jumping: usize,
    size: f64,
    rows: usize,
    sample_time_s: f64,
) -> Result<Dataset, IdentifyError> {
    let all: Vec<&Channel> = model.inputs().chain(model.outputs()).collect();
    let named = all.into_iter().enumerate().filter_map(|(index, channel)| {
        let mut values = vec![0.0; rows];
        if index == jumping {
            values[IMPULSE_ROW] = size / channel.transform.amplification(sample_time_s);
        }
        Some((socam_recording::Channel::from_column_name(&channel.column)?, values))
    });
    let (channels, values) = named.unzip();
    let time_s = (0..rows).map(|k| k as f64 * sample_time_s).collect();
    Ok(Dataset::from_columns("impulse", channels, time_s, values)?)
}
