//! Outliers: single output values that neither the model nor the neighbouring values explain.
//!
//! After a fit, each innovation (residual less its prediction from past residuals) is divided by the standard deviation of the bulk of
//! the innovations. Few and isolated large ones are left out, and the fit is repeated. Many of them, or long clusters, are misfit of
//! the model and stay.

use std::{ops::Range, sync::Arc};

use crate::{
    IdentifyError, Problem,
    evaluation::{self, Point, Weights},
    noise::{innovations_filter::NoiseLevels, levels},
    optimiser::nuisance,
    preprocessing::{
        mask::{LeftOut, Reason},
        outlier_detector::{ALONE, OutlierStatistics, THRESHOLD, bin_start},
        segments::{self, Segment},
        spikes,
    },
};

/// Largest share of a channel's values that can be outliers. If there are more, the model does not describe them.
const MOST_SHARE: f64 = 0.005;

/// Most passes of the search: once large outliers are masked, smaller ones exceed the threshold.
const MOST_PASSES: usize = 3;

/// Outliers of a problem's recordings, for a model with parameter `values` (SI) and noise `levels`. Only nuisance parameters (start
/// states and offsets) are fitted, so that recordings that no fit has seen can be searched too.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, outliers};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let problem = Problem::of_known(&model, &recordings, Options::default())?;
/// let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// assert!(outliers(&problem, &model.values(), &levels)?.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read or the equations cannot be formed at `values`.
pub fn outliers(
    problem: &Problem<'_>,
    values: &[f64],
    levels: &NoiseLevels,
) -> Result<Vec<LeftOut>, IdentifyError> {
    let mut preprocessed = problem.clone();
    for _ in 0..MOST_PASSES {
        let point =
            Point { values: values.to_vec(), nuisance: evaluation::first_nuisance(&preprocessed, values)? };
        let weights = Weights {
            input_std: levels.inputs.clone(),
            ..Weights::white(levels.outputs.clone(), Vec::new())
        };
        let parameterless = levels::without_parameters(&preprocessed);
        let Some(at) = nuisance::with_nuisance_fitted(&parameterless, point, weights)? else { break };
        if !leave_out(&mut preprocessed, &at.point, &at.weights)? {
            break;
        }
    }
    Ok(preprocessed.left_out.into_iter().filter(|note| note.reason == Reason::Outliers).collect())
}

/// Masks the outliers at a point and adds their reports to the problem; returns false if there are none. Channels with too many large
/// residuals are reported as [`Problem::misfits`] instead.
pub(crate) fn leave_out(
    problem: &mut Problem<'_>,
    point: &Point,
    weights: &Weights,
) -> Result<bool, IdentifyError> {
    let channels: Vec<String> = problem.model.outputs().map(|channel| channel.name.clone()).collect();
    let units = weights.noise_std.clone();
    problem.misfits.clear();
    let statistics_at = |sizes: Vec<f64>| statistics_at(problem, point, weights, sizes);
    let Some(bulk) = statistics_at(vec![1.0; channels.len()])? else { return Ok(false) };
    let sizes: Vec<f64> = (0..channels.len()).map(|output| bulk_size(&bulk, output)).collect();
    let stands_out = |output: usize| {
        bulk.iter().any(|statistics| statistics[output].largest() > THRESHOLD * sizes[output])
    };
    if !(0..channels.len()).any(stands_out) {
        return Ok(false);
    }
    let Some(seen) = statistics_at(sizes)? else { return Ok(false) };
    let mut found = false;
    for (output, channel) in channels.iter().enumerate() {
        let statistics = || seen.iter().map(|statistics| &statistics[output]);
        let large: u64 = statistics().map(|track| track.large).sum();
        let all: u64 = statistics().flat_map(|track| &track.histogram).sum();
        if large as f64 > MOST_SHARE * all as f64 {
            problem.misfits.push(misfit(channel, large, all));
            continue;
        }
        let each: Vec<Vec<(Range<u64>, f64)>> = statistics().map(|track| track.alone.clone()).collect();
        for (index, alone) in each.into_iter().enumerate() {
            found |= mask_outliers(problem, index, output, alone, units[output])?;
        }
    }
    Ok(found)
}

fn misfit(channel: &str, large: u64, all: u64) -> String {
    format!(
        "{channel}: {large} samples ({:.1} %) are further from the prediction than {THRESHOLD} standard deviations of the rest; so many are no outliers: the model does not describe them",
        100.0 * large as f64 / all as f64
    )
}

/// Per segment, the statistics of each output in units of `sizes`; `None` where the prediction overflows.
fn statistics_at(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    sizes: Vec<f64>,
) -> Result<Option<Vec<Vec<OutlierStatistics>>>, IdentifyError> {
    let parameterless = levels::without_parameters(problem);
    let weights = Weights { detector: Some(Arc::new(sizes)), scales: Vec::new(), ..weights.clone() };
    let results = evaluation::run(&parameterless, point, &weights)?;
    Ok(results.map(|results| results.into_iter().filter_map(|result| result.detector).collect()))
}

/// Standard deviation of an output's bulk, from the median of the magnitudes.
fn bulk_size(seen: &[Vec<OutlierStatistics>], output: usize) -> f64 {
    let bins = seen.first().map_or(0, |statistics| statistics[output].histogram.len());
    let sums: Vec<u64> =
        (0..bins).map(|bin| seen.iter().map(|statistics| statistics[output].histogram[bin]).sum()).collect();
    let all: u64 = sums.iter().sum();
    let mut below = 0;
    let middle = sums.iter().position(|count| {
        below += count;
        2 * below >= all
    });
    middle.map_or(1.0, |bin| 0.5 * (bin_start(bin) + bin_start(bin + 1)) / 0.6745)
}

/// Masks those candidates of a segment that the neighbouring values do not explain either; returns whether there are any.
fn mask_outliers(
    problem: &mut Problem<'_>,
    index: usize,
    output: usize,
    alone: Vec<(Range<u64>, f64)>,
    unit: f64,
) -> Result<bool, IdentifyError> {
    let mut rows = Vec::new();
    for (own, residual) in alone {
        if is_in_the_data(problem, &problem.segments[index], output, &own, residual * unit)? {
            let first = problem.segments[index].first_row;
            rows.push(first + own.start..first + own.end);
        }
    }
    let recording = problem.segments[index].recording;
    let dataset = &problem.datasets[recording];
    let channel = problem.model.outputs().nth(output).map_or("", |channel| &channel.name);
    let Some(note) = LeftOut::new(dataset, channel, Reason::Outliers, &rows) else { return Ok(false) };
    note.join(&mut problem.left_out);
    let mut mask = (*problem.segments[index].mask).clone();
    mask.add(output, rows);
    let mask = Arc::new(mask);
    let own = problem.segments.iter_mut().filter(|segment| segment.recording == recording);
    own.for_each(|segment| segment.mask = Arc::clone(&mask));
    Ok(true)
}

/// Whether the measured values differ from their neighbours about as much as from the prediction. Otherwise the prediction changes
/// suddenly and the measured motion does not.
fn is_in_the_data(
    problem: &Problem<'_>,
    segment: &Segment,
    output: usize,
    rows: &Range<u64>,
    residual: f64,
) -> Result<bool, IdentifyError> {
    let reach = spikes::REACH as u64;
    if rows.start < reach || rows.end + reach > segment.rows {
        return Ok(true);
    }
    let first_row = segment.first_row + rows.start - reach;
    let near = Segment { first_row, rows: rows.end - rows.start + 2 * reach, ..segment.clone() };
    let mut values = Vec::new();
    let dataset = &problem.datasets[segment.recording];
    segments::read(problem.model, dataset, &near, &problem.intersample, |chunk| {
        values.extend_from_slice(&chunk.outputs[output]);
    })?;
    let gap = spikes::REACH..values.len() - spikes::REACH;
    let off = spikes::off_imputed(&mut values, gap);
    // If a neighbour is missing, the test is left out.
    Ok(off.is_nan() || off >= ALONE * residual.abs())
}
