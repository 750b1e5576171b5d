//! Noise levels of outputs and inputs by maximum likelihood of the residuals.
//!
//! At given parameters the residuals are Gaussian; their covariance depends on the levels of output and input noise. Each evaluation
//! gives the derivative of the log-likelihood (the score) and the Fisher information with respect to the logarithms of the variances, from
//! innovations filters at perturbed levels. Fisher scoring converges in a few evaluations.

use std::sync::Arc;

use socam_model::Equations;

use crate::{
    IdentifyError,
    evaluation::{self, Point, Weights},
    noise::{
        innovations_filter::NoiseLevels,
        level_score::{PerturbedFilters, Score, of, scaled},
    },
    problem::{Problem, sample_times},
};

/// Predicted gain of log-likelihood below which the iteration ends.
const LEAST_GAIN: f64 = 0.05;

/// Number of rows of each of the first segments that the first steps use.
const FIRST_ROWS: u64 = 2000;

const FIRST_SEGMENTS: usize = 6;

const FIRST_STEPS: usize = 12;

/// Most steps on all data.
const MOST_STEPS: usize = 3;

/// Gain of the deviance from which residuals hold evidence of noise of the inputs.
const EVIDENT: f64 = 10.0;

/// Noise levels of maximum likelihood at given parameters, from `start`. They stay below `most`; levels that the model file gives keep
/// their values. Inputs are exact where neither the first rows nor all of them hold evidence of their noise: whitening by a filter that
/// follows the parameters costs ten times as much as a sum of squares.
pub(crate) fn maximum_likelihood(
    problem: &Problem<'_>,
    point: &Point,
    start: NoiseLevels,
    most: &NoiseLevels,
) -> Result<NoiseLevels, IdentifyError> {
    let mut kept: Vec<usize> = (0..problem.segments.len()).collect();
    let whole = without_sensitivities(problem, &kept, u64::MAX);
    kept.truncate(FIRST_SEGMENTS);
    let head = without_sensitivities(problem, &kept, FIRST_ROWS);
    let head_point = Point { values: point.values.clone(), nuisance: point.nuisance[..kept.len()].to_vec() };
    let levels = fisher_scoring(&head, &head_point, start, most, FIRST_STEPS)?;
    if problem.model.inputs().any(|channel| channel.noise_std.is_some_and(|std| std > 0.0)) {
        return fisher_scoring(&whole, point, levels, most, MOST_STEPS);
    }
    let mut exact = exact_inputs(&head, &head_point, &levels, most)?;
    if exact.is_some() {
        exact = exact_inputs(&whole, point, &levels, most)?;
    }
    exact.map_or_else(|| fisher_scoring(&whole, point, levels, most, MOST_STEPS), Ok)
}

/// Levels with exact inputs, where the residuals are about as likely under them as under `levels`.
fn exact_inputs(
    problem: &Problem<'_>,
    point: &Point,
    levels: &NoiseLevels,
    most: &NoiseLevels,
) -> Result<Option<NoiseLevels>, IdentifyError> {
    let equations = problem.model.equations(&point.values)?;
    let Some(score) = score(problem, point, &equations, levels, &[])? else { return Ok(None) };
    let channels = problem.model.outputs().zip(&levels.outputs).zip(&most.outputs);
    let mut deviance = 0.0;
    let mut outputs = Vec::new();
    for (((channel, unit), most), squares) in channels.zip(&score.squares) {
        if *squares == 0.0 {
            // A channel without values has no level.
            outputs.push(*unit);
            continue;
        }
        let estimate = (unit * (squares / score.samples.max(1.0)).sqrt()).min(*most);
        let std = channel.noise_std.unwrap_or(estimate);
        let variance = (std / unit).powi(2);
        deviance += score.samples * variance.ln() + squares / variance;
        outputs.push(std);
    }
    let inputs = vec![0.0; levels.inputs.len()];
    Ok((deviance - score.deviance < EVIDENT).then_some(NoiseLevels { outputs, inputs }))
}

/// The problem with all parameters fixed: its evaluations give residuals and the sensitivities of nuisance parameters only.
pub(crate) fn without_parameters<'a>(problem: &Problem<'a>) -> Problem<'a> {
    let all: Vec<usize> = (0..problem.segments.len()).collect();
    without_sensitivities(problem, &all, u64::MAX)
}

/// The problem with all parameters fixed, restricted to the segments `kept` and to the first `rows` rows of each.
fn without_sensitivities<'a>(problem: &Problem<'a>, kept: &[usize], rows: u64) -> Problem<'a> {
    let shortened = |index: &usize| problem.segments[*index].head(rows);
    Problem { free: Vec::new(), ..problem.with_segments(kept.iter().map(shortened).collect()) }
}

/// Estimates the noise levels by at most `steps` steps of Fisher scoring.
fn fisher_scoring(
    problem: &Problem<'_>,
    point: &Point,
    start: NoiseLevels,
    most: &NoiseLevels,
    steps: usize,
) -> Result<NoiseLevels, IdentifyError> {
    let equations = problem.model.equations(&point.values)?;
    let channels: Vec<_> = problem.model.outputs().chain(problem.model.inputs()).collect();
    let outputs = start.outputs.len();
    let mut levels = start;
    for _ in 0..steps {
        let noisy = |level: &usize| *level < outputs || levels.inputs[*level - outputs] > 0.0;
        let open = |level: &usize| channels[*level].noise_std.is_none();
        let sought: Vec<usize> = (0..channels.len()).filter(noisy).filter(open).collect();
        if sought.is_empty() {
            break;
        }
        let Some(mut score) = score(problem, point, &equations, &levels, &sought)? else { break };
        let is_full = |level: usize| of(&levels, level) > (1.0 - 1e-9) * of(most, level);
        (0..sought.len()).filter(|k| is_full(sought[*k])).for_each(|k| score.hold_if_rising(k));
        let (step, gain) = score.step();
        for (level, change) in sought.iter().zip(step) {
            let headroom = 2.0 * (of(most, *level) / of(&levels, *level)).ln();
            levels = scaled(&levels, *level, change.min(headroom));
        }
        if gain < LEAST_GAIN {
            break;
        }
    }
    Ok(levels)
}

/// Score and information at some levels; `None` where a filter does not exist or the prediction overflows.
fn score(
    problem: &Problem<'_>,
    point: &Point,
    equations: &Equations,
    levels: &NoiseLevels,
    sought: &[usize],
) -> Result<Option<Score>, IdentifyError> {
    let units = &levels.outputs;
    let perturbed_filters: Option<Vec<_>> = sample_times(problem)
        .into_iter()
        .map(|time_s| {
            Some((
                time_s,
                PerturbedFilters::new(equations, levels, sought, units, time_s, &problem.intersample)?,
            ))
        })
        .collect();
    let Some(perturbed_filters) = perturbed_filters else { return Ok(None) };
    let weights = Weights {
        perturbed_filters: Arc::new(perturbed_filters),
        ..Weights::white(units.clone(), Vec::new())
    };
    let Some(results) = evaluation::run(problem, point, &weights)? else { return Ok(None) };
    let mut sum = Score::new(sought.len(), units.len());
    results.iter().filter_map(|result| result.levels.as_ref()).for_each(|score| sum.add(score));
    Ok(Some(sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_that_is_held_leaves_the_others_alone() {
        let mut score = Score {
            sensitivity: nalgebra::DVector::from_vec(vec![-80.0, 5000.0]),
            information: nalgebra::DMatrix::from_row_slice(2, 2, &[99.0, 60.0, 60.0, 99.0]),
            ..Score::new(2, 1)
        };
        score.hold_if_rising(0);
        assert!(score.step().0[0] != 0.0, "it falls");
        score.hold_if_rising(1);
        let (step, gain) = score.step();
        assert_eq!(step[1], 0.0);
        assert!((step[0] + 0.8).abs() < 1e-12 && gain < 40.0, "{step:?} {gain}");
    }
}
