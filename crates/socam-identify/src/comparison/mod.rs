//! Models compared on equal terms: the same recordings, the same noise, the same filters.
//!
//! Whether a model explains recordings better than another one is seen in the sum of squares of what both leave, provided that
//! both are measured by one [`NoiseModel`]: noise levels and whitening filters of one reference model, which then stay. A fit
//! by it is an ordinary descent ([`descend`]); how much a further parameter would help is foretold without one ([`screen`]).

pub mod cross_validation;
mod model_evaluation;
mod noise_model;
mod score_test;
mod traces;

pub use model_evaluation::Evaluation;
pub(crate) use model_evaluation::begin;
pub use noise_model::{NoiseModel, noise};
pub use score_test::{CandidateScore, score_test};
pub use traces::{Innovations, Traces, innovations, traces};

use socam_model::Model;

use crate::optimiser::descent::End;
use crate::{
    IdentifyError,
    noise::levels,
    optimiser::{descent, nuisance},
    problem::Problem,
    progress::Stage,
};

/// A descent ends when a step promises less than this of the sum of squares, in units of noise as strong as what is left: where
/// models are compared, and where values matter.
pub const COARSE: f64 = 2.0;

/// See [`COARSE`].
pub const FINE: f64 = 0.05;

/// Goes down from `start` (all parameters, SI; start states as in `from`, where the model has the same) by a noise_model; `None`
/// where the model overflows there.
///
/// # Errors
/// When a recording cannot be read.
pub fn descend(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    start: &[f64],
    from: Option<(&Model, &Evaluation)>,
    (tolerance, max_iterations): (f64, usize),
) -> Result<Option<Evaluation>, IdentifyError> {
    let Some(point) = begin(problem, start, from)? else { return Ok(None) };
    let weights = noise_model.weights(problem, start);
    let stage = Stage::Descent { round: 1 };
    match descent::descend(problem, point, weights, tolerance, max_iterations, stage) {
        Ok(descent) => {
            let converged = matches!(descent.end, End::Converged | End::AtBound);
            Ok(Some(model_evaluation::measured(problem, &descent.point, &descent.evaluated, converged)))
        }
        Err(IdentifyError::Diverged { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// The model at given values; only what is local to a recording is fitted to it.
///
/// # Errors
/// When a recording cannot be read.
pub fn measure(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    values: &[f64],
) -> Result<Option<Evaluation>, IdentifyError> {
    let problem = levels::blind(problem);
    let Some(point) = begin(&problem, values, None)? else { return Ok(None) };
    let weights = noise_model.weights(&problem, values);
    let Some(at) = nuisance::with_nuisance_fitted(&problem, point, weights)? else { return Ok(None) };
    Ok(Some(model_evaluation::measured(&problem, &at.point, &at.evaluated, true)))
}
