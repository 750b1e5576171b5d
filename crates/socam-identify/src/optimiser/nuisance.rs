//! Fits of the nuisance parameters alone: start states and offsets at given parameters.

use crate::{
    IdentifyError,
    evaluation::{self, Point, SegmentEvaluation, Weights, squares},
    optimiser::{
        descent::{Descent, End, SHORTER},
        noise_estimation::first_weights,
        step::moved,
    },
    prediction::modal::offset_channels,
    preprocessing::segments::Segment,
    problem::{Problem, StartState},
};

/// Largest number of steps.
const MOST_START_STEPS: usize = 20;

/// Share of the sum of squares below which the decrease by a step, or the predicted one in each segment, ends the fit.
const SETTLED: f64 = 1e-6;

/// Rows of the heads of each segment to which the start states of a model with force laws are fitted, one after the other.
const HEADS: [u64; 3] = [32, 128, 512];

/// Smallest share of a step that is tried.
const LEAST_SHARE: f64 = 1e-2;

/// Nuisance parameters of a segment (an uninterrupted part of a recording).
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// Index of the recording.
    pub recording: usize,
    /// First row of the segment.
    pub first_row: u64,
    /// States at that row, in the order of [`socam_model::Equations::state_names`], SI.
    pub states: Vec<f64>,
    /// Offset of each output, SI: zero where none is estimated.
    pub offsets: Vec<f64>,
}

/// The start states and offsets that [`evaluate`](fn@crate::evaluate) fits.
///
/// ```
/// use socam_identify::{Options, Problem, start_states};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let problem = Problem::of_known(&model, &recordings, Options::default())?;
/// let found = start_states(&problem, &model.values())?;
/// assert_eq!((found.len(), found[0].first_row, found[0].states.len()), (1, 0, 3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The errors of [`evaluate`](fn@crate::evaluate).
pub fn start_states(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<Local>, IdentifyError> {
    let fitted = fitted_nuisance(problem, values)?;
    let estimated = offset_channels(problem);
    let local = |(segment, own): (&Segment, Vec<f64>)| {
        let (states, shifts) = own.split_at(own.len() - estimated.len());
        let mut offsets = vec![0.0; problem.outputs()];
        estimated.iter().zip(shifts).for_each(|(output, shift)| offsets[*output] = *shift);
        let Segment { recording, first_row, .. } = *segment;
        Local { recording, first_row, states: states.to_vec(), offsets }
    };
    Ok(problem.segments.iter().zip(fitted).map(local).collect())
}

/// First nuisance parameters by segment: start states from the first samples, offsets zero.
///
/// The start states of a model with force laws are then fitted to longer and longer heads of their segment. A recording that begins in the
/// middle of a swing does not show its speed in the first sample, and a fit of the whole segment from a wrong one drags the parameters away.
/// A short head shows it whatever the parameters are.
pub(crate) fn first(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<Vec<f64>>, IdentifyError> {
    let mut point = Point { values: values.to_vec(), nuisance: evaluation::first_nuisance(problem, values)? };
    if !has_heads(problem, values)? {
        return Ok(point.nuisance);
    }
    for rows in HEADS {
        let heads = problem.segments.iter().map(|segment| segment.head(rows)).collect();
        let heads = Problem { free: Vec::new(), ..problem.with_segments(heads) };
        let Ok(weights) = first_weights(&heads, &point) else { break };
        let Some(fitted) = with_nuisance_fitted(&heads, point.clone(), weights)? else { break };
        point.nuisance = fitted.point.nuisance;
    }
    Ok(point.nuisance)
}

/// Whether start states are fitted to heads of the segments first: those of a model with force laws that are free.
pub(crate) fn has_heads(problem: &Problem<'_>, values: &[f64]) -> Result<bool, IdentifyError> {
    let is_free = problem.options.start_state == StartState::Free;
    Ok(is_free && !evaluation::is_linear(&problem.model.equations(values)?))
}

/// Nuisance parameters fitted at given parameter values, by segment.
pub(crate) fn fitted_nuisance(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<Vec<f64>>, IdentifyError> {
    Ok(with_nuisance(problem, values)?.point.nuisance)
}

/// A model at given parameter values with fitted nuisance parameters, under first noise levels.
pub(crate) fn with_nuisance(problem: &Problem<'_>, values: &[f64]) -> Result<Descent, IdentifyError> {
    let diverged = || IdentifyError::Diverged { model: problem.model.name.clone() };
    let point = Point { values: values.to_vec(), nuisance: first(problem, values)? };
    let weights = first_weights(problem, &point)?;
    with_nuisance_fitted(problem, point, weights)?.ok_or_else(diverged)
}

/// A point with its nuisance parameters fitted; `None` where the prediction overflows.
pub(crate) fn with_nuisance_fitted(
    problem: &Problem<'_>,
    point: Point,
    weights: Weights,
) -> Result<Option<Descent>, IdentifyError> {
    let Some(evaluated) = evaluation::run(problem, &point, &weights)? else { return Ok(None) };
    let mut at = Descent {
        cost: squares(&evaluated),
        point,
        weights,
        evaluated,
        iterations: 0,
        end: End::Converged,
        left_the_data: None,
    };
    refit(problem, &mut at)?;
    Ok(Some(at))
}

/// Sum of squared weighted residuals at other parameter values, with the weights of `from` and nuisance parameters refitted; `None`
/// where the prediction overflows.
pub(crate) fn squares_at(
    problem: &Problem<'_>,
    from: &Descent,
    values: Vec<f64>,
) -> Result<Option<f64>, IdentifyError> {
    let point = Point { values, nuisance: from.point.nuisance.clone() };
    Ok(with_nuisance_fitted(problem, point, from.weights.clone())?.map(|at| at.cost))
}

/// Gauss-Newton in the nuisance parameters alone. One step is exact for a linear model; force laws need a few. Segments do not depend on each
/// other here: each has its own steps, and is left alone once it has settled.
pub(crate) fn refit(problem: &Problem<'_>, at: &mut Descent) -> Result<(), IdentifyError> {
    let still = vec![0.0; problem.free.len()];
    let mut shares = vec![1.0; at.evaluated.len()];
    let has_settled =
        |result: &SegmentEvaluation| result.nuisance_gain() <= SETTLED * result.weighted_squares;
    for _ in 0..MOST_START_STEPS {
        let is_open = |index: &usize| !has_settled(&at.evaluated[*index]) && shares[*index] >= LEAST_SHARE;
        let open: Vec<usize> = (0..shares.len()).filter(is_open).collect();
        if open.is_empty() {
            break;
        }
        let whole = moved(problem, at.linearisation(), &still, 1.0);
        let part = |index: &usize| -> Vec<f64> {
            let (from, to) = (&at.point.nuisance[*index], &whole.nuisance[*index]);
            from.iter().zip(to).map(|(from, to)| from + shares[*index] * (to - from)).collect()
        };
        let trial = Point { values: at.point.values.clone(), nuisance: open.iter().map(part).collect() };
        let segments = open.iter().map(|index| problem.segments[*index].clone()).collect();
        let evaluated = evaluation::run(&problem.with_segments(segments), &trial, &at.weights)?;
        let Some(evaluated) = evaluated else {
            open.iter().for_each(|index| shares[*index] *= SHORTER);
            continue;
        };
        for ((index, result), nuisance) in open.into_iter().zip(evaluated).zip(trial.nuisance) {
            let before = at.evaluated[index].weighted_squares;
            if result.weighted_squares < before {
                let is_over = result.weighted_squares >= before * (1.0 - SETTLED);
                shares[index] = if is_over { 0.0 } else { (shares[index] / SHORTER).min(1.0) };
                (at.point.nuisance[index], at.evaluated[index]) = (nuisance, result);
            } else {
                shares[index] *= SHORTER;
            }
        }
    }
    at.cost = squares(&at.evaluated);
    Ok(())
}
