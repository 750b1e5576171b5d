//! Cross-validation over recordings without refits: predictive loss of a model for recordings to which its parameters were not
//! fitted.
//!
//! At a fit, the triangular factor of each recording over [free parameters | residual] gives the change of its sum of squares for
//! any small change of the parameters. The fit without one recording is therefore one linear step away, and so is its prediction
//! error for that recording (the leave-one-group-out form of R. D. Cook's deletion, Technometrics 19, 1977). Start states are
//! fitted to each recording.
//!
//! # Breaks when
//! A recording moves the parameters so far that the model is not linear in between.

use faer::Mat;
use socam_model::Model;

use crate::{
    IdentifyError,
    comparison::{Evaluation, NoiseModel, begin},
    evaluation::{self, SegmentEvaluation, Weights},
    matrix::{Svd, SymmetricEigen, gram, product},
    optimiser::{descent::LEAST_DAMPING, factors, qr, step},
    problem::Problem,
};

/// Singular values below this fraction of the largest are truncated.
const LEAST_SINGULAR: f64 = 1e-6;
/// Least information that the other recordings are assumed to have on a direction, as a fraction of the information of all
/// recordings.
const LEAST_LEFT: f64 = 0.02;

/// Predictive losses of a model at a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossValidation {
    /// Sum of squared whitened residuals of each recording, at parameters that are fitted to the other recordings.
    pub held_out: Vec<f64>,
    /// Sums of squared whitened residuals of each recording at the fit, over blocks of 0.2 s.
    pub blocks: Vec<Vec<f64>>,
    /// All parameters after one more step without damping, SI. Along directions that the recordings do not determine a descent ends anywhere;
    /// this is the point nearest to the model file's values, at which plausibility can be judged.
    pub nearest: Vec<f64>,
}

impl CrossValidation {
    /// Predictive log score up to a constant that all models share: -1/2 of the held-out sum of squares.
    #[must_use]
    pub fn log_score(&self) -> f64 {
        -0.5 * self.held_out.iter().sum::<f64>()
    }
}

/// Predictive losses at a fit with each recording of `problem` left out in turn. `at` is the evaluation of `model` at its fit.
/// `None` if sensitivities overflow.
///
/// ```
/// use socam_identify::comparison::{NoiseModel, cross_validation::leave_one_out, measure};
/// use socam_identify::{NoiseLevels, Options, Problem};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// # let recordings = [recordings[0].clone(), recordings[0].clone()];
/// # let problem = Problem::new(&model, &recordings, Options::default())?;
/// # let values = model.values();
/// # let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// # let noise_model = NoiseModel::new(&[&problem], &values, levels.clone())?;
/// let at = measure(&problem, &noise_model, &values)?.expect("no overflow");
/// let losses = leave_one_out(&problem, &noise_model, &model, &at)?.expect("no overflow");
/// assert_eq!(losses.held_out.len(), 2);
/// assert_eq!(losses.log_score(), -0.5 * (losses.held_out[0] + losses.held_out[1]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read.
pub fn leave_one_out(
    problem: &Problem<'_>,
    noise: &NoiseModel,
    model: &Model,
    at: &Evaluation,
) -> Result<Option<CrossValidation>, IdentifyError> {
    let Some(point) = begin(problem, &at.values, Some((model, at)))? else { return Ok(None) };
    let weights = Weights { scores: true, ..noise.weights(problem, &at.values) };
    let Some(evaluated) = evaluation::run(problem, &point, &weights)? else { return Ok(None) };
    let free = problem.free.len();
    let factor = factors::global_factor(problem, &point, &weights, &evaluated);
    let Some(root) = covariance_root(&factor, free) else { return Ok(None) };
    let step = step::constrained_step(problem, &point, &weights, factor.as_ref(), LEAST_DAMPING);
    let nearest = step.map_or_else(
        || point.values.clone(),
        |step| step::moved(problem, (&point, &weights, &evaluated), &step, 1.0).values,
    );
    let recordings = problem.datasets.len();
    let (mut held_out, mut blocks) = (vec![0.0; recordings], vec![Vec::new(); recordings]);
    for recording in 0..recordings {
        let own =
            || problem.segments.iter().zip(&evaluated).filter(|(segment, _)| segment.recording == recording);
        let squares: f64 = own().map(|(_, result)| result.weighted_squares).sum();
        let Some(change) = change_of_loss(&root, free, own().map(|(_, result)| result)) else {
            return Ok(None);
        };
        held_out[recording] = squares + change;
        blocks[recording] = own().flat_map(|(_, result)| result.block_squares.iter().copied()).collect();
    }
    Ok(Some(CrossValidation { held_out, blocks, nearest }))
}

/// Square root of the inverse of the information of all recordings: it has `free` rows, and a column for each direction that the
/// recordings determine.
fn covariance_root(factor: &Mat<f64>, free: usize) -> Option<Mat<f64>> {
    let lengths = qr::lengths(factor.as_ref(), free);
    let scaled = Mat::from_fn(factor.nrows(), free, |i, j| factor[(i, j)] / lengths[j]);
    let svd = Svd::new(&scaled)?;
    let sizes: Vec<f64> = (0..free.min(scaled.nrows())).map(|k| svd.values[k]).collect();
    let largest = sizes.first().copied().unwrap_or(0.0);
    let kept: Vec<usize> = (0..sizes.len()).filter(|k| sizes[*k] > LEAST_SINGULAR * largest).collect();
    Some(Mat::from_fn(free, kept.len(), |j, k| svd.right[(j, kept[k])] / sizes[kept[k]] / lengths[j]))
}

/// Increase of the sum of squares of one recording when the parameters are fitted without it.
fn change_of_loss<'r>(
    root: &Mat<f64>,
    free: usize,
    own: impl Iterator<Item = &'r SegmentEvaluation>,
) -> Option<f64> {
    let width = root.ncols();
    let (mut gradient, mut curvature) = (Mat::<f64>::zeros(width, 1), Mat::<f64>::zeros(width, width));
    for result in own {
        let schur_complement = result.schur_complement();
        let sensitivities = product(schur_complement.subcols(0, free), root);
        gradient += product(sensitivities.transpose(), schur_complement.subcols(free, 1));
        curvature += gram(&sensitivities);
    }
    // At a fit the scores of all recordings sum to zero, so that the sum over the other recordings is minus the score of this one.
    let eigen = SymmetricEigen::new(&curvature)?;
    let along = product(eigen.vectors.transpose(), &gradient);
    let change = (0..width).map(|k| {
        let share = eigen.values[k].clamp(0.0, 1.0);
        let step = along[(k, 0)] / (1.0 - share).max(LEAST_LEFT);
        2.0 * along[(k, 0)] * step + share * step * step
    });
    Some(change.sum())
}
