//! Fits of the nuisance parameters alone: start states and offsets at given parameters.

use crate::optimiser::descent::End;
use crate::{
    IdentifyError,
    evaluation::{self, Point, SegmentEvaluation, Weights, squares},
    optimiser::{
        descent::{Descent, SHORTER},
        noise_estimation::first_weights,
        step::moved,
    },
    prediction::modal::offset_channels,
    preprocessing::segments::Segment,
    problem::Problem,
};

/// Steps of the start states when only they are fitted.
pub(crate) const MOST_START_STEPS: usize = 20;

/// They have settled when a step gains less than this share of the sum of squares, or promises less in each segment.
pub(crate) const SETTLED_LOCALS: f64 = 1e-9;

pub(crate) const LEAST_SHARE: f64 = 1e-2;

/// What is local to an uninterrupted part of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// Index of the recording.
    pub recording: usize,
    /// Its first row there.
    pub first_row: u64,
    /// States at that row, in the order of [`socam_model::Equations::state_names`], SI.
    pub states: Vec<f64>,
    /// What is added to each output, SI: zero where no offset is estimated.
    pub offsets: Vec<f64>,
}

/// The start states and offsets that [`evaluate`] fits: with them the model, running free, has the residuals that it reports.
///
/// # Errors
/// As those of [`evaluate`].
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

/// For each segment what [`evaluate`] fits to it.
pub(crate) fn fitted_nuisance(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<Vec<f64>>, IdentifyError> {
    Ok(with_nuisance(problem, values)?.point.nuisance)
}

/// Given parameter values, and what is local to a recording fitted to it.
pub(crate) fn with_nuisance(problem: &Problem<'_>, values: &[f64]) -> Result<Descent, IdentifyError> {
    let diverged = || IdentifyError::Diverged { model: problem.model.name.clone() };
    let point = Point { values: values.to_vec(), nuisance: evaluation::first_nuisance(problem, values)? };
    let weights = first_weights(problem, &point)?;
    with_nuisance_fitted(problem, point, weights)?.ok_or_else(diverged)
}

/// A point with what is local fitted to each recording; `None` where the prediction overflows.
pub(crate) fn with_nuisance_fitted(
    problem: &Problem<'_>,
    point: Point,
    weights: Weights,
) -> Result<Option<Descent>, IdentifyError> {
    let Some(evaluated) = evaluation::run(problem, &point, &weights)? else { return Ok(None) };
    let mut at =
        Descent { cost: squares(&evaluated), point, weights, evaluated, iterations: 0, end: End::Converged };
    refit_locals(problem, &mut at)?;
    Ok(Some(at))
}

/// Sum of squared weighted residuals at other parameter values, weights as they are, start states refitted; `None` where the
/// prediction overflows.
pub(crate) fn squares_at(
    problem: &Problem<'_>,
    from: &Descent,
    values: Vec<f64>,
) -> Result<Option<f64>, IdentifyError> {
    let point = Point { values, nuisance: from.point.nuisance.clone() };
    Ok(with_nuisance_fitted(problem, point, from.weights.clone())?.map(|at| at.cost))
}

/// Moves start states and offsets only, until that no longer helps: one step is exact for a linear model, a law that
/// bends the motion needs a few.
pub(crate) fn refit_locals(problem: &Problem<'_>, at: &mut Descent) -> Result<(), IdentifyError> {
    let still = vec![0.0; problem.free.len()];
    let mut share = 1.0;
    for _ in 0..MOST_START_STEPS {
        if at
            .evaluated
            .iter()
            .all(|result| promised_by_nuisance(result) <= SETTLED_LOCALS * result.weighted_squares)
        {
            break;
        }
        let trial = moved(problem, at, &still, share);
        let evaluated = evaluation::run_below(problem, &trial, &at.weights, at.cost)?;
        let evaluated = evaluated.filter(|evaluated| squares(evaluated) < at.cost);
        let Some(evaluated) = evaluated else {
            share *= SHORTER;
            if share < LEAST_SHARE {
                break;
            }
            continue;
        };
        let cost = squares(&evaluated);
        let is_over = cost >= at.cost * (1.0 - SETTLED_LOCALS);
        (at.point, at.evaluated, at.cost) = (trial, evaluated, cost);
        if is_over {
            break;
        }
    }
    Ok(())
}

/// What moving a segment's local unknowns alone would take from its sum of squares, were the motion linear in them.
pub(crate) fn promised_by_nuisance(result: &SegmentEvaluation) -> f64 {
    let residual = result.factor.col(result.factor.ncols() - 1);
    result.pivots.iter().flatten().map(|row| residual[*row].powi(2)).sum()
}
