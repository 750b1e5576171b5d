//! Evaluation of residuals and sensitivities over all data at given parameters, segment by segment.

pub(crate) mod accumulator;
mod segment;
mod start;
pub(crate) mod weights;

pub(crate) use accumulator::ResidualAccumulator;
pub(crate) use segment::{ChannelSums, SegmentEvaluation, blocks, channel_sums, squares};
pub(crate) use start::first_nuisance;
pub(crate) use weights::{Point, Weights};

use std::sync::Arc;

use rayon::prelude::*;
use socam_model::Equations;

use crate::{
    IdentifyError,
    evaluation::start::law_states,
    noise::prewhitening,
    prediction::{exponential::SampleSteps, modal::Modal, sensitivity_integrator::SensitivityIntegrator},
    problem::{Problem, StartState},
};

/// Results by segment; `None` where the prediction overflowed.
pub(crate) type Evaluated = Option<Vec<SegmentEvaluation>>;

/// Evaluates the model on every segment, in parallel; results are in the order of the segments.
pub(crate) fn run(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
) -> Result<Evaluated, IdentifyError> {
    run_below(problem, point, weights, f64::INFINITY)
}

/// Like [`run`], but given up as soon as one segment has a sum of squares above `most`: a step to such a point is refused anyway, and such
/// predictions are often slow.
pub(crate) fn run_below(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    most: f64,
) -> Result<Evaluated, IdentifyError> {
    let is_tentative = problem.options.progress.is_tentative();
    evaluated(problem, point, weights, (most, is_tentative))
}

/// Like [`run_below`], and given up where the search is ended: the step is then not made.
pub(crate) fn run_trial(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    most: f64,
) -> Result<Evaluated, IdentifyError> {
    evaluated(problem, point, weights, (most, true))
}

/// Evaluates the model on every segment. It is given up where a segment has a sum of squares above `most`, and, if it is tentative, where the
/// search is ended.
fn evaluated(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    (most, is_tentative): (f64, bool),
) -> Result<Evaluated, IdentifyError> {
    problem.options.progress.proceed()?;
    let Ok((equations, sensitivities)) =
        problem.model.equations_with_derivatives(&point.values, &problem.free)
    else {
        // Parameters outside the physical range: the optimiser shortens the step.
        return Ok(None);
    };
    let prewhitenings = match &weights.frozen {
        Some(frozen) => Arc::clone(frozen),
        None => {
            match prewhitening::all(problem, &point.values, &weights.levels(), &weights.scales, &equations) {
                Some(prewhitenings) => Arc::new(prewhitenings),
                None => return Ok(None),
            }
        }
    };
    let free_start = problem.options.start_state == StartState::Free;
    let still = if free_start { law_states(&equations) } else { Vec::new() };
    let linear = is_linear(&equations);
    let modal = if linear { Modal::new(problem, &equations, &sensitivities, point, weights) } else { None };
    // One integrator per sample time: making one costs more than evaluating a short segment.
    let mut integrators: Vec<(SampleSteps, Option<SensitivityIntegrator<'_>>)> = Vec::new();
    for segment in problem.segments.iter().filter(|_| modal.is_none()) {
        let steps = segment.steps();
        if integrators.iter().all(|(known, _)| *known != steps) {
            let integrator =
                SensitivityIntegrator::new(problem, &equations, &sensitivities, point, weights, steps);
            integrators.push((steps, integrator));
        }
    }
    let one = |index: usize| -> Result<Option<SegmentEvaluation>, IdentifyError> {
        problem.options.progress.proceed()?;
        let (time_s, steps) = (problem.segments[index].sample_time_s, problem.segments[index].steps());
        let prewhitening = prewhitenings.iter().find(|prewhitening| prewhitening.sample_time_s == time_s);
        let mut rows =
            ResidualAccumulator::new(problem, time_s, weights, prewhitening, point.nuisance[index].len());
        rows.still.clone_from(&still);
        rows.most = most;
        rows.tentative = is_tentative.then(|| problem.options.progress.clone());
        let integrator = || integrators.iter().find(|(known, _)| *known == steps)?.1.as_ref();
        let finite = match &modal {
            Some(modal) => modal.predict(problem, index, point, weights, &mut rows)?,
            None => integrator()
                .map_or(Ok(false), |integrator| integrator.predict(problem, index, point, &mut rows))?,
        };
        Ok(if finite { rows.finish() } else { None })
    };
    // One segment per task, for load balance.
    let segments = (0..problem.segments.len()).into_par_iter().with_max_len(1);
    let results: Result<Vec<_>, _> = segments.map(one).collect();
    Ok(results?.into_iter().collect())
}

/// Whether no force law depends on the motion.
pub(crate) fn is_linear(equations: &Equations) -> bool {
    equations.ports.iter().all(socam_model::Port::is_constant)
}
