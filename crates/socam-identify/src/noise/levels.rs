//! Noise levels of outputs and inputs by maximum likelihood of the residuals.
//!
//! At given parameters the residuals are Gaussian; their covariance depends on the levels of output and input noise. Each evaluation
//! gives the derivative of the log-likelihood (the score) and the Fisher information with respect to the logarithms of the variances, from
//! innovations filters at perturbed levels. Fisher scoring converges in a few evaluations.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use socam_model::Equations;

use crate::{
    IdentifyError, Intersample, Problem,
    evaluation::{self, Point, Weights},
    noise::{
        filter_batch::{FilterBatch, FilterState},
        innovations_filter::{InnovationsFilter, NoiseLevels},
    },
    preprocessing::segments::Segment,
    problem::sample_times,
};

/// Step of central differences in the logarithm of a variance.
const STEP: f64 = 0.05;
/// Largest step in the logarithm of a variance.
const LONGEST: f64 = 1.5;
/// Predicted gain of log-likelihood below which the iteration ends.
const LEAST_GAIN: f64 = 0.05;
/// The first steps use so many rows of each of the first segments, at most so many segments and steps.
const FIRST_ROWS: u64 = 2000;
const FIRST_SEGMENTS: usize = 6;
const FIRST_STEPS: usize = 12;
/// Most steps on all data.
const MOST_STEPS: usize = 3;

/// Noise levels of maximum likelihood at given parameters, from `start`. They stay below `most`; levels that the model file gives keep
/// their values.
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
    fisher_scoring(&whole, point, levels, most, MOST_STEPS)
}

/// The same problem without free parameters: its evaluations give residuals and the sensitivities of nuisance parameters only.
pub(crate) fn without_parameters<'a>(problem: &Problem<'a>) -> Problem<'a> {
    let all: Vec<usize> = (0..problem.segments.len()).collect();
    without_sensitivities(problem, &all, u64::MAX)
}

/// Part of a problem without free parameters: the segments `kept`, of each at most `rows` rows.
fn without_sensitivities<'a>(problem: &Problem<'a>, kept: &[usize], rows: u64) -> Problem<'a> {
    let shortened = |index: &usize| {
        let segment = &problem.segments[*index];
        Segment { rows: segment.rows.min(rows), ..segment.clone() }
    };
    Problem::of_segments(
        (problem.model, problem.datasets),
        Vec::new(),
        kept.iter().map(shortened).collect(),
        problem.options.clone(),
        problem.intersample.clone(),
    )
}

/// At most `steps` steps of Fisher scoring.
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
    let mut sum = Score::new(sought.len());
    results.iter().filter_map(|result| result.levels.as_ref()).for_each(|score| sum.add(score));
    Ok(Some(sum))
}

/// The innovations filter at some noise levels, and those at each level a little larger and a little smaller.
pub(crate) struct PerturbedFilters {
    /// At the levels, then for each level that is estimated at a larger and a smaller value.
    filters: FilterBatch,
    inverse_root: DMatrix<f64>,
    /// Derivative of the innovation's covariance with respect to each log variance, in units of its root.
    spreads: Vec<DMatrix<f64>>,
}

/// Score and Fisher information of the log variances.
#[derive(Debug, Clone)]
pub(crate) struct Score {
    pub(crate) sensitivity: DVector<f64>,
    pub(crate) information: DMatrix<f64>,
}

impl Score {
    pub(crate) fn new(levels: usize) -> Self {
        Self { sensitivity: DVector::zeros(levels), information: DMatrix::zeros(levels, levels) }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.sensitivity += &other.sensitivity;
        self.information += &other.information;
    }

    /// Removes a level from the step if the likelihood rises with it: for a level at its upper bound.
    fn hold_if_rising(&mut self, level: usize) {
        if self.sensitivity[level] > 0.0 {
            self.sensitivity[level] = 0.0;
            self.information.row_mut(level).fill(0.0);
            self.information.column_mut(level).fill(0.0);
        }
    }

    /// Step of the logarithms of the variances, and the gain of log-likelihood that it predicts.
    pub(crate) fn step(&self) -> (Vec<f64>, f64) {
        let levels = self.sensitivity.len();
        // The identity keeps a level without information where it is.
        let information = &self.information + DMatrix::identity(levels, levels);
        let step = information.lu().solve(&self.sensitivity).unwrap_or_else(|| DVector::zeros(levels));
        let step = step.map(|s| s.clamp(-LONGEST, LONGEST));
        let gain = self.sensitivity.dot(&step) - 0.5 * step.dot(&(&self.information * &step));
        (step.as_slice().to_vec(), gain)
    }
}

/// A level by its index: outputs first, then inputs. NaN beyond them.
fn of(levels: &NoiseLevels, sought: usize) -> f64 {
    levels.outputs.iter().chain(&levels.inputs).nth(sought).copied().unwrap_or(f64::NAN)
}

/// The levels with one log variance changed; `sought` is the index of the level.
pub(crate) fn scaled(levels: &NoiseLevels, sought: usize, log_change: f64) -> NoiseLevels {
    let mut levels = levels.clone();
    let outputs = levels.outputs.len();
    let std =
        if sought < outputs { &mut levels.outputs[sought] } else { &mut levels.inputs[sought - outputs] };
    *std *= (0.5 * log_change).exp();
    levels
}

impl PerturbedFilters {
    /// `None` where one of the filters does not exist.
    pub(crate) fn new(
        equations: &Equations,
        levels: &NoiseLevels,
        sought: &[usize],
        units: &[f64],
        sample_time_s: f64,
        intersample: &[Intersample],
    ) -> Option<Self> {
        let filter = |levels: &NoiseLevels| {
            InnovationsFilter::new(equations, levels, units, sample_time_s, intersample)
        };
        let centre = filter(levels)?;
        let root = centre.inverse_root();
        let mut filters = vec![centre];
        let mut spreads = Vec::new();
        for level in sought {
            let pair = [filter(&scaled(levels, *level, STEP))?, filter(&scaled(levels, *level, -STEP))?];
            let sensitivity = (&pair[0].covariance - &pair[1].covariance) / (2.0 * STEP);
            spreads.push(&root * sensitivity * root.transpose());
            filters.extend(pair);
        }
        let filters = FilterBatch::new(&filters.iter().collect::<Vec<_>>());
        Some(Self { filters, inverse_root: root, spreads })
    }

    pub(crate) fn start(&self) -> LevelScore<'_> {
        LevelScore {
            perturbed: self,
            filters: self.filters.initial_state(),
            score: Score::new(self.spreads.len()),
        }
    }
}

/// Score along one segment.
pub(crate) struct LevelScore<'p> {
    perturbed: &'p PerturbedFilters,
    filters: FilterState,
    pub(crate) score: Score,
}

impl LevelScore<'_> {
    /// Adds the residuals of one sample, one per output. Samples with a missing output only update the filters.
    pub(crate) fn take(&mut self, residual: &[f64], present: &[bool]) {
        let PerturbedFilters { filters, inverse_root, spreads } = self.perturbed;
        filters.advance(&mut self.filters, residual, present);
        if present.contains(&false) {
            return;
        }
        let (stride, outputs) = (filters.stride(), residual.len());
        let innovation = |output: usize, lane: usize| self.filters.innovation[output * stride + lane];
        let white = DVector::from_fn(outputs, |o, _| self.filters.white[o * stride]);
        // Derivative of the innovation with respect to each level, in units of the covariance's root.
        let moved = DMatrix::from_fn(outputs, spreads.len(), |o, level| {
            (innovation(o, 2 * level + 1) - innovation(o, 2 * level + 2)) / (2.0 * STEP)
        });
        let moved = inverse_root * moved;
        for (i, spread) in spreads.iter().enumerate() {
            let sensitivity = moved.column(i);
            self.score.sensitivity[i] +=
                0.5 * (white.dot(&(spread * &white)) - spread.trace()) - white.dot(&sensitivity);
            for (j, other) in spreads.iter().enumerate() {
                self.score.information[(i, j)] += 0.5 * spread.dot(other) + sensitivity.dot(&moved.column(j));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_that_is_held_leaves_the_others_alone() {
        let mut score = Score {
            sensitivity: DVector::from_vec(vec![-80.0, 5000.0]),
            information: DMatrix::from_row_slice(2, 2, &[99.0, 60.0, 60.0, 99.0]),
        };
        score.hold_if_rising(0);
        assert!(score.step().0[0] != 0.0, "it falls");
        score.hold_if_rising(1);
        let (step, gain) = score.step();
        assert_eq!(step[1], 0.0);
        assert!((step[0] + 0.8).abs() < 1e-12 && gain < 40.0, "{step:?} {gain}");
    }
}
