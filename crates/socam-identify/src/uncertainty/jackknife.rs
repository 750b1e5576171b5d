//! Intervals clustered by recording (CV3, the jackknife): differences between recordings that noise does not explain are model error.

use faer::Mat;
use socam_model::Model;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::{
    IdentifyError,
    comparison::{Evaluation, NoiseModel, begin},
    evaluation::{self, SegmentEvaluation, Weights},
    matrix::{Svd, SymmetricEigen, gram, product},
    optimiser::{factors, qr},
    problem::Problem,
};

/// Smallest number of recordings for an estimate.
const LEAST_RECORDINGS: usize = 3;
/// Singular values below this fraction of the largest are truncated.
const LEAST_WEIGHT: f64 = 1e-6;
/// Smallest share of a direction's information that the other recordings are taken to hold. A direction that one recording alone determines
/// cannot be checked against the others.
const LEAST_LEFT: f64 = 0.1;

/// Half widths of 95 % intervals by parameter of the model (SI; zero for fixed ones), from the score of each recording at a fit (`at`, made
/// with `model`). Residuals may be correlated within a recording in any way. `None` with too few recordings.
///
/// The sandwich estimate clustered by recording with leave-one-out scores (the jackknife, CV3) and Student's t of m-1 degrees of freedom
/// (A. C. Cameron, D. L. Miller, J. Human Resources 50, 2015, section VI). It gives no information on a parameter that one recording alone
/// determines, and misses errors that are the same in all recordings.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, comparison::{NoiseModel, measure}, uncertainty::jackknife};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// # let problem = Problem::new(&model, &recordings, Options::default())?;
/// # let values = model.values();
/// # let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// # let noise_model = NoiseModel::new(&[&problem], &values, levels.clone())?;
/// let at = measure(&problem, &noise_model, &values)?.expect("no overflow");
/// // A single recording shows no differences between recordings.
/// assert_eq!(jackknife::half_widths(&problem, &noise_model, &model, &at)?, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read.
pub fn half_widths(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    model: &Model,
    at: &Evaluation,
) -> Result<Option<Vec<f64>>, IdentifyError> {
    let recordings = problem.datasets.len();
    if recordings < LEAST_RECORDINGS {
        return Ok(None);
    }
    let Some(fit) = Sensitivities::at(problem, noise_model, model, at)? else { return Ok(None) };
    let Sensitivities { evaluated, root, weights } = &fit;
    let free = problem.free.len();
    let mut scores = Mat::<f64>::zeros(free, recordings);
    for (segment, result) in problem.segments.iter().zip(evaluated) {
        add_score(result, free, scores.as_mut().col_mut(segment.recording));
    }
    let mut apart = product(root.transpose(), &scores);
    for (recording, mut score) in apart.col_iter_mut().enumerate() {
        let own =
            problem.segments.iter().zip(evaluated).filter(|(segment, _)| segment.recording == recording);
        let share = own.fold(Mat::<f64>::zeros(root.ncols(), root.ncols()), |share, (_, result)| {
            let schur_complement = result.schur_complement();
            share + gram(product(schur_complement.subcols(0, free), root))
        });
        let Some(eigen) = SymmetricEigen::new(&share) else { return Ok(None) };
        let along = product(eigen.vectors.transpose(), score.as_ref().as_mat());
        let without =
            Mat::from_fn(root.ncols(), 1, |k, _| along[(k, 0)] / (1.0 - eigen.values[k]).max(LEAST_LEFT));
        score.copy_from(product(&eigen.vectors, &without).col(0));
    }
    let steps = product(root, &apart);
    let m = recordings as f64;
    let t = StudentsT::new(0.0, 1.0, m - 1.0).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975));
    let mut widths = vec![0.0; problem.model.parameters.len()];
    for (j, index) in problem.free.iter().enumerate() {
        let squares: f64 = (0..recordings).map(|r| steps[(j, r)].powi(2)).sum();
        widths[*index] = t * ((m - 1.0) / m * squares).sqrt() * weights.scales[j].abs();
    }
    Ok(Some(widths))
}

/// Sensitivities at a fit.
struct Sensitivities {
    evaluated: Vec<SegmentEvaluation>,
    /// Root of the free parameters' covariance in white noise, scaled.
    root: Mat<f64>,
    weights: Weights,
}

impl Sensitivities {
    fn at(
        problem: &Problem<'_>,
        noise_model: &NoiseModel,
        model: &Model,
        at: &Evaluation,
    ) -> Result<Option<Self>, IdentifyError> {
        let Some(point) = begin(problem, &at.values, Some((model, at)))? else { return Ok(None) };
        let weights = Weights { scores: true, ..noise_model.weights(problem, &at.values) };
        let Some(evaluated) = evaluation::run(problem, &point, &weights)? else { return Ok(None) };
        let free = problem.free.len();
        let information = factors::information_factor(problem, &point, &weights, &evaluated);
        let lengths = qr::lengths(information.as_ref(), free);
        let scaled = Mat::from_fn(information.nrows(), free, |i, j| information[(i, j)] / lengths[j]);
        let Some(svd) = Svd::new(&scaled) else { return Ok(None) };
        let sizes: Vec<f64> = (0..free.min(scaled.nrows())).map(|k| svd.values[k]).collect();
        let kept: Vec<usize> = (0..sizes.len()).filter(|k| sizes[*k] > LEAST_WEIGHT * sizes[0]).collect();
        let root =
            Mat::from_fn(free, kept.len(), |j, k| svd.right[(j, kept[k])] / sizes[kept[k]] / lengths[j]);
        Ok(Some(Self { evaluated, root, weights }))
    }
}

/// Adds the score of a segment after elimination of its nuisance parameters.
fn add_score(result: &SegmentEvaluation, free: usize, mut score: faer::ColMut<'_, f64>) {
    let schur_complement = result.schur_complement();
    for j in 0..free {
        score[j] += (0..schur_complement.nrows())
            .map(|i| schur_complement[(i, j)] * schur_complement[(i, free)])
            .sum::<f64>();
    }
}
