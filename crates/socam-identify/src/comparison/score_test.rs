//! The score test: how much freeing parameters would lower the sum of squares, predicted from sensitivities without a fit.

use faer::{Mat, MatRef};
use socam_model::Model;

use crate::{
    IdentifyError,
    comparison::{Evaluation, NoiseModel, begin},
    evaluation::{self, SegmentEvaluation, Weights},
    matrix::{Svd, gram, product, solve_symmetric},
    optimiser::qr,
    problem::Problem,
};

/// Largest group of parameters that is one effect. The parameters of a larger group are points of a curve, which may be nearly dependent:
/// it is regularised by [`RIDGE`].
const FEW: usize = 4;

/// Ridge, as a share of the information of each parameter.
const RIDGE: f64 = 1e-3;

/// Share of a column's norm after orthogonalisation below which the parameter is dependent on the base.
const LEAST_OWN: f64 = 1e-7;

/// Effect of freeing a group of parameters, predicted from sensitivities.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateScore {
    /// Decrease of the sum of squared whitened residuals.
    pub gain: f64,
    /// Sum of squares at the values.
    pub total: f64,
    /// Step of each parameter, SI; zero where the parameter changes no residual.
    pub step: Vec<f64>,
    /// Standard error of each step for white residuals, SI; infinite where the parameter changes no residual.
    pub std: Vec<f64>,
    /// Share of the first parameter's change of the residuals that no change of the base makes, 0 to 1.
    pub own: f64,
    /// Change of each base parameter that goes with these steps, SI, in the order of the base.
    pub base_step: Vec<f64>,
    /// Standard error of that change from the steps' errors alone, for white residuals, SI.
    pub base_std: Vec<f64>,
    /// Change of the first parameter alone that changes the sum of squares by one, SI; infinite where none does.
    pub resolution: f64,
    /// Efficient scores (orthogonal to the base parameters) by block of 0.2 s in the order of the recordings, over the parameters of the
    /// group; empty where the group changes no residual.
    pub scores: Vec<Vec<f64>>,
}

/// The effect of freeing each of `groups` (indices of the parameters of one candidate) along with the `base` parameters, at `values` (all
/// parameters, SI) and the nuisance parameters of `at`, an evaluation of `model`. One result per group; `None` if sensitivities overflow.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, comparison::{NoiseModel, measure, score_test}};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// # let problem = Problem::new(&model, &recordings, Options::default())?;
/// # let values = model.values();
/// # let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// # let noise_model = NoiseModel::new(&[&problem], &values, levels.clone())?;
/// let stiffness = model.parameter("stiffness").unwrap();
/// let mut wrong = values.clone();
/// wrong[stiffness] *= 1.1;
/// let at = measure(&problem, &noise_model, &wrong)?.expect("no overflow");
/// let scores = score_test(&problem, &noise_model, &wrong, (&model, &at), &[], &[vec![stiffness]])?.expect("no overflow");
/// assert!(scores[0].gain > 0.0 && scores[0].step[0] < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read.
pub fn score_test(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    values: &[f64],
    (model, at): (&Model, &Evaluation),
    base: &[usize],
    groups: &[Vec<usize>],
) -> Result<Option<Vec<CandidateScore>>, IdentifyError> {
    let Some(point) = begin(problem, values, Some((model, at)))? else { return Ok(None) };
    let weights = Weights { scores: true, ..noise_model.weights(problem, values) };
    let Some(evaluated) = evaluation::run(problem, &point, &weights)? else { return Ok(None) };
    let free = problem.free.len();
    let factor = qr::join(evaluated.iter().map(SegmentEvaluation::schur_complement), free + 1);
    let column = |index: &usize| problem.free.iter().position(|free| free == index);
    let base: Vec<usize> = base.iter().filter_map(column).collect();
    let blocks = evaluation::blocks(&evaluated, free);
    let orthogonalised = Orthogonalised {
        total: evaluation::squares(&evaluated),
        ..Orthogonalised::new(factor.as_ref(), base)
    };
    let each = groups.iter().map(|group| {
        let own: Vec<usize> = group.iter().filter_map(column).collect();
        let mut score = orthogonalised.score(&own, &blocks);
        for values in [&mut score.step, &mut score.std] {
            values.iter_mut().zip(&own).for_each(|(value, column)| *value *= weights.scales[*column]);
        }
        for values in [&mut score.base_step, &mut score.base_std] {
            let along_base = values.iter_mut().zip(&orthogonalised.base);
            along_base.for_each(|(value, column)| *value *= weights.scales[*column]);
        }
        score.resolution *= own.first().map_or(1.0, |column| weights.scales[*column]);
        score
    });
    Ok(Some(each.collect()))
}

/// Sensitivities of all parameters, orthogonalised against those of the base.
struct Orthogonalised<'f> {
    factor: MatRef<'f, f64>,
    base: Vec<usize>,
    /// Orthonormal basis of the base's sensitivities, and its coefficients in terms of them.
    basis: Mat<f64>,
    coefficients: Mat<f64>,
    /// Sum of squares.
    total: f64,
}

impl<'f> Orthogonalised<'f> {
    fn new(factor: MatRef<'f, f64>, base: Vec<usize>) -> Self {
        let rows = factor.nrows();
        let lengths: Vec<f64> =
            base.iter().map(|j| factor.col(*j).norm_l2().max(f64::MIN_POSITIVE)).collect();
        let scaled = Mat::from_fn(rows, base.len(), |i, j| factor[(i, base[j])] / lengths[j]);
        let (mut basis, mut coefficients) = (Mat::zeros(rows, 0), Mat::zeros(base.len(), 0));
        if let Some(svd) = Svd::new(&scaled) {
            let sizes: Vec<f64> = (0..base.len().min(rows)).map(|k| svd.values[k]).collect();
            let kept: Vec<usize> = (0..sizes.len()).filter(|k| sizes[*k] > 1e-6 * sizes[0]).collect();
            basis = Mat::from_fn(rows, kept.len(), |i, k| svd.left[(i, kept[k])]);
            coefficients = Mat::from_fn(base.len(), kept.len(), |j, k| {
                svd.right[(j, kept[k])] / (sizes[kept[k]] * lengths[j])
            });
        }
        Self { factor, base, basis, coefficients, total: 0.0 }
    }

    /// A column orthogonalised against the base, and its coefficients on the base's columns.
    fn own(&self, column: usize) -> (Vec<f64>, Vec<f64>) {
        let full = self.factor.col(column);
        let shares: Vec<f64> = (0..self.basis.ncols())
            .map(|k| (0..full.nrows()).map(|i| self.basis[(i, k)] * full[i]).sum())
            .collect();
        let rest = (0..full.nrows())
            .map(|i| full[i] - (0..shares.len()).map(|k| self.basis[(i, k)] * shares[k]).sum::<f64>())
            .collect();
        let taken = (0..self.base.len())
            .map(|j| (0..shares.len()).map(|k| self.coefficients[(j, k)] * shares[k]).sum())
            .collect();
        (rest, taken)
    }

    fn score(&self, group: &[usize], blocks: &[Vec<f64>]) -> CandidateScore {
        let nothing = CandidateScore {
            gain: 0.0,
            total: self.total,
            step: vec![0.0; group.len()],
            std: vec![f64::INFINITY; group.len()],
            own: 0.0,
            base_step: vec![0.0; self.base.len()],
            base_std: vec![0.0; self.base.len()],
            resolution: f64::INFINITY,
            scores: Vec::new(),
        };
        let (residual, _) = self.own(self.factor.ncols() - 1);
        let own: Vec<(Vec<f64>, Vec<f64>)> = group.iter().map(|column| self.own(*column)).collect();
        let lengths: Vec<f64> = own.iter().map(|(rest, _)| length(rest)).collect();
        let counts = |k: &usize| {
            lengths[*k] > LEAST_OWN * self.factor.col(group[*k]).norm_l2() && lengths[*k].is_normal()
        };
        let kept: Vec<usize> = (0..group.len()).filter(counts).collect();
        // If one effect has few parameters, all of them must change the residuals; of the many points of a curve, only the excited
        // ones are used.
        if kept.is_empty() || (kept.len() < group.len() && group.len() <= FEW) {
            return nothing;
        }
        let n = kept.len();
        let sensitivities = Mat::from_fn(residual.len(), n, |i, k| own[kept[k]].0[i] / lengths[kept[k]]);
        let right = Mat::from_fn(residual.len(), 1, |i, _| -residual[i]);
        let ridge = if n > FEW { RIDGE } else { 0.0 };
        let gram = gram(&sensitivities) + Mat::<f64>::identity(n, n) * faer::Scale(ridge);
        let Some(step) = solved(&gram, &product(sensitivities.transpose(), &right)) else { return nothing };
        let rest = |i: usize| residual[i] + (0..n).map(|k| sensitivities[(i, k)] * step[k]).sum::<f64>();
        let after: f64 = (0..residual.len()).map(|i| rest(i).powi(2)).sum();
        let gain = (residual.iter().map(|r| r * r).sum::<f64>() - after).max(0.0);
        // Scores of the group's own part, block by block.
        let scores: Vec<Vec<f64>> = blocks
            .iter()
            .map(|block| {
                let each = kept.iter().map(|k| {
                    let base: f64 =
                        self.base.iter().zip(&own[*k].1).map(|(j, share)| block[*j] * share).sum();
                    (block[group[*k]] - base) / lengths[*k]
                });
                each.collect()
            })
            .collect();
        let own_share = lengths[kept[0]] / self.factor.col(group[kept[0]]).norm_l2();
        let resolution = 1.0 / lengths[kept[0]];
        let mut score = CandidateScore { gain, own: own_share, resolution, scores, ..nothing };
        for (index, k) in kept.iter().enumerate() {
            let unit = Mat::from_fn(n, 1, |i, _| f64::from(i == index));
            let variance = solved(&gram, &unit).map_or(f64::INFINITY, |column| column[index]);
            score.step[*k] = step[index] / lengths[*k];
            score.std[*k] = variance.max(0.0).sqrt() / lengths[*k];
            // The base takes back what the column shares with it.
            for (base, taken) in own[*k].1.iter().enumerate() {
                score.base_step[base] -= taken * score.step[*k];
                score.base_std[base] = score.base_std[base].hypot(taken * score.std[*k]);
            }
        }
        score
    }
}

fn length(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Solution of a small symmetric system; `None` where it is singular.
fn solved(matrix: &Mat<f64>, right: &Mat<f64>) -> Option<Vec<f64>> {
    let solution = solve_symmetric(matrix, right)?;
    (0..matrix.nrows()).map(|k| Some(solution[(k, 0)]).filter(|value| value.is_finite())).collect()
}
