//! One pass over the data at given parameters: for each segment, the triangular factor of residuals and sensitivities.

mod accumulator;
mod segment;
mod start;
mod weights;

pub(crate) use accumulator::ResidualAccumulator;
pub(crate) use segment::{ChannelSums, SegmentEvaluation, blocks, channel_sums, squares};
pub(crate) use start::first_nuisance;
pub(crate) use weights::{Point, Weights};

use std::sync::Arc;

use rayon::prelude::*;
use socam_model::Equations;

use crate::{
    IdentifyError,
    evaluation::start::remembered,
    noise::prewhitening,
    prediction::{modal::Modal, sensitivity_integrator::SensitivityIntegrator},
    problem::{Problem, StartState},
};

/// The whole pass; `None` where the prediction overflowed.
pub(crate) type PassResult = Option<Vec<SegmentEvaluation>>;

/// Runs the model over every segment, in parallel; the order of the result is that of the segments.
pub(crate) fn run(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
) -> Result<PassResult, IdentifyError> {
    run_below(problem, point, weights, f64::INFINITY)
}

/// The same, given up as soon as one segment alone has a sum of squares of more than `most`: what leads there is not wanted, and often
/// takes the shortest steps that there are.
pub(crate) fn run_below(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    most: f64,
) -> Result<PassResult, IdentifyError> {
    let Ok((equations, sensitivities)) =
        problem.model.equations_with_derivatives(&point.values, &problem.free)
    else {
        // A step beyond what physics allows; the solver will shorten it.
        return Ok(None);
    };
    let prewhitenings = match &weights.frozen {
        Some(frozen) => Arc::clone(frozen),
        None => match prewhitening::all(problem, point, weights, &equations) {
            Some(prewhitenings) => Arc::new(prewhitenings),
            None => return Ok(None),
        },
    };
    let free_start = problem.options.start_state == StartState::Free;
    let still = if free_start { remembered(&equations) } else { Vec::new() };
    let linear = is_linear(&equations);
    let modal = if linear { Modal::new(problem, &equations, &sensitivities, point, weights) } else { None };
    // One for each sample time: to make it costs more than a short segment takes.
    let mut integrators: Vec<(f64, Option<SensitivityIntegrator<'_>>)> = Vec::new();
    for segment in problem.segments.iter().filter(|_| modal.is_none()) {
        let time_s = segment.sample_time_s;
        if integrators.iter().all(|(known_s, _)| *known_s != time_s) {
            let integrator =
                SensitivityIntegrator::new(problem, &equations, &sensitivities, point, weights, time_s);
            integrators.push((time_s, integrator));
        }
    }
    let one = |index: usize| -> Result<Option<SegmentEvaluation>, IdentifyError> {
        let time_s = problem.segments[index].sample_time_s;
        let prewhitening = prewhitenings.iter().find(|prewhitening| prewhitening.sample_time_s == time_s);
        let mut rows =
            ResidualAccumulator::new(problem, time_s, weights, prewhitening, point.nuisance[index].len());
        rows.still.clone_from(&still);
        rows.most = most;
        let integrator = || integrators.iter().find(|(known_s, _)| *known_s == time_s)?.1.as_ref();
        let finite = match &modal {
            Some(modal) => modal.predict(problem, index, point, weights, &mut rows)?,
            None => integrator()
                .map_or(Ok(false), |integrator| integrator.predict(problem, index, point, &mut rows))?,
        };
        Ok(if finite { rows.finish() } else { None })
    };
    // One at a time: whoever is free takes the next.
    let segments = (0..problem.segments.len()).into_par_iter().with_max_len(1);
    let results: Result<Vec<_>, _> = segments.map(one).collect();
    Ok(results?.into_iter().collect())
}

/// No law depends on anything.
fn is_linear(equations: &Equations) -> bool {
    equations.ports.iter().all(socam_model::Port::is_constant)
}
