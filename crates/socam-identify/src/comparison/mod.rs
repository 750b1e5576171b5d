//! Comparison of models on the same recordings under one noise model.
//!
//! Sums of squares of two models can be compared if both are evaluated under one [`NoiseModel`]: noise levels and whitening filters of a
//! reference model, held fixed. [`descend`] fits a model under it; [`score_test`](fn@score_test) predicts, without a fit, how much further
//! parameters would lower the sum of squares.

pub mod cross_validation;
mod excerpt;
mod model_evaluation;
mod noise_model;
mod score_test;
mod traces;

pub use excerpt::{Excerpt, on_excerpt};
pub use model_evaluation::Evaluation;
pub(crate) use model_evaluation::begin;
pub use noise_model::{Innovations, NoiseModel, innovations, noise};
pub use score_test::{CandidateScore, score_test};
pub use traces::{Traces, traces};

use socam_model::Model;

use crate::{
    IdentifyError,
    evaluation::Point,
    noise::levels,
    optimiser::{
        descent::{self, End},
        nuisance,
    },
    problem::Problem,
    progress::Stage,
};

/// Tolerance of a descent where models are compared: the predicted decrease of the sum of squares, in units of the mean squared residual,
/// below which it ends.
pub const COARSE: f64 = 2.0;

/// Tolerance of a descent where parameter values matter, in the same unit as [`COARSE`].
pub const FINE: f64 = 0.05;

/// Fits a model under a noise model, from `start` (all parameters, SI) and the nuisance parameters of `from` as far as the models share
/// them. `None` where the model overflows at the start.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, comparison::{FINE, NoiseModel, descend, measure}};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// # let problem = Problem::new(&model, &recordings, Options::default())?;
/// # let values = model.values();
/// # let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// # let noise_model = NoiseModel::new(&[&problem], &values, levels.clone())?;
/// let at_truth = measure(&problem, &noise_model, &values)?.expect("no overflow");
/// let mut start = values.clone();
/// start[model.parameter("stiffness").unwrap()] *= 1.2;
/// let fitted = descend(&problem, &noise_model, &start, None, (FINE, 50))?.expect("no overflow");
/// assert!(fitted.converged && fitted.total() < at_truth.total() + FINE);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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

/// Evaluates a model at given values (all parameters, SI). Only nuisance parameters are fitted. `None` where the model overflows.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, comparison::{NoiseModel, measure}};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// # let problem = Problem::new(&model, &recordings, Options::default())?;
/// # let values = model.values();
/// # let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// # let noise_model = NoiseModel::new(&[&problem], &values, levels.clone())?;
/// let at = measure(&problem, &noise_model, &values)?.expect("no overflow");
/// // The mean square of the residuals is that of the noise.
/// let reduced = at.total() / at.count.iter().sum::<f64>();
/// assert!((reduced - 1.0).abs() < 0.1, "{reduced}");
/// assert_eq!(at.on_one(&problem, 0).total(), at.total());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read.
pub fn measure(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    values: &[f64],
) -> Result<Option<Evaluation>, IdentifyError> {
    let problem = levels::without_parameters(problem);
    let Some(point) = begin(&problem, values, None)? else { return Ok(None) };
    let weights = noise_model.weights(&problem, values);
    let mut fits = vec![nuisance::with_nuisance_fitted(&problem, point, weights.clone())?];
    // Start states of a model with force laws may end in a local minimum: they are also fitted from those of short heads.
    if nuisance::has_heads(&problem, values)? {
        let point = Point { values: values.to_vec(), nuisance: nuisance::first(&problem, values)? };
        fits.push(nuisance::with_nuisance_fitted(&problem, point, weights)?);
    }
    let best = fits.into_iter().flatten().min_by(|a, b| a.cost.total_cmp(&b.cost));
    Ok(best.map(|at| model_evaluation::measured(&problem, &at.point, &at.evaluated, true)))
}
