//! The score test: how much freeing parameters would lower the sum of squares, predicted from sensitivities without a fit.

use faer::{Mat, MatRef};
use socam_model::Model;

use crate::{
    IdentifyError,
    comparison::{Evaluation, NoiseModel, begin},
    evaluation::{self, SegmentEvaluation, Weights},
    optimiser::qr,
    problem::Problem,
};

/// Parameters that stand for one effect; more are points of a curve, which may be next to dependent on one another and are kept
/// small by a pull of [`RIDGE`] of what the data say of each.
const FEW: usize = 4;

const RIDGE: f64 = 1e-3;

/// Columns of which so little is left beside others are nothing of their own.
const LEAST_OWN: f64 = 1e-7;

/// How much freeing parameters would help, foretold from sensitivities.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateScore {
    /// Fall of the sum of squares, from what it is at the values.
    pub gain: f64,
    /// Sum of squares at the values.
    pub total: f64,
    /// Step of each parameter, SI; none for one that moves nothing.
    pub step: Vec<f64>,
    /// Standard error of each, SI, as far as noise goes; infinite for one that moves nothing.
    pub std: Vec<f64>,
    /// Change of the first parameter alone that moves the sum of squares by one, SI; infinite where nothing does.
    pub resolution: f64,
    /// Efficient scores (those of the group with what the base can do taken out), block by block of 0.2 s in the order of the recordings,
    /// by parameter of the group; none where the group moves nothing.
    pub scores: Vec<Vec<f64>>,
}

/// For each of `groups` (indices of free parameters that belong together) what freeing it along with `base` would do; `at` was
/// measured with `model`. `None` where sensitivities overflow.
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
    let picture = Picture { total: evaluation::squares(&evaluated), ..Picture::new(factor.as_ref(), base) };
    let each = groups.iter().map(|group| {
        let own: Vec<usize> = group.iter().filter_map(column).collect();
        let mut promise = picture.promise(&own, &blocks);
        for values in [&mut promise.step, &mut promise.std] {
            values.iter_mut().zip(&own).for_each(|(value, column)| *value *= weights.scales[*column]);
        }
        promise.resolution *= own.first().map_or(1.0, |column| weights.scales[*column]);
        promise
    });
    Ok(Some(each.collect()))
}

/// Sensitivities of all parameters with those of the base taken out.
struct Picture<'f> {
    factor: MatRef<'f, f64>,
    base: Vec<usize>,
    /// Orthonormal columns that span the base's sensitivities, and how they are made of them.
    span: Mat<f64>,
    made: Mat<f64>,
    /// Sum of squares.
    total: f64,
}

impl<'f> Picture<'f> {
    fn new(factor: MatRef<'f, f64>, base: Vec<usize>) -> Self {
        let rows = factor.nrows();
        let lengths: Vec<f64> =
            base.iter().map(|j| factor.col(*j).norm_l2().max(f64::MIN_POSITIVE)).collect();
        let scaled = Mat::from_fn(rows, base.len(), |i, j| factor[(i, base[j])] / lengths[j]);
        let (mut span, mut made) = (Mat::zeros(rows, 0), Mat::zeros(base.len(), 0));
        if let Ok(svd) = scaled.thin_svd() {
            let sizes: Vec<f64> = (0..base.len().min(rows)).map(|k| svd.S()[k]).collect();
            let kept: Vec<usize> = (0..sizes.len()).filter(|k| sizes[*k] > 1e-6 * sizes[0]).collect();
            span = Mat::from_fn(rows, kept.len(), |i, k| svd.U()[(i, kept[k])]);
            made = Mat::from_fn(base.len(), kept.len(), |j, k| {
                svd.V()[(j, kept[k])] / (sizes[kept[k]] * lengths[j])
            });
        }
        Self { factor, base, span, made, total: 0.0 }
    }

    /// A column without what the base can do, and how much of each of the base's columns was taken from it.
    fn own(&self, column: usize) -> (Vec<f64>, Vec<f64>) {
        let full = self.factor.col(column);
        let shares: Vec<f64> = (0..self.span.ncols())
            .map(|k| (0..full.nrows()).map(|i| self.span[(i, k)] * full[i]).sum())
            .collect();
        let rest = (0..full.nrows())
            .map(|i| full[i] - (0..shares.len()).map(|k| self.span[(i, k)] * shares[k]).sum::<f64>())
            .collect();
        let taken = (0..self.base.len())
            .map(|j| (0..shares.len()).map(|k| self.made[(j, k)] * shares[k]).sum())
            .collect();
        (rest, taken)
    }

    fn promise(&self, group: &[usize], blocks: &[Vec<f64>]) -> CandidateScore {
        let nothing = CandidateScore {
            gain: 0.0,
            total: self.total,
            step: vec![0.0; group.len()],
            std: vec![f64::INFINITY; group.len()],
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
        // Of a few that belong together each has to count; of many, those do that were excited.
        if kept.is_empty() || (kept.len() < group.len() && group.len() <= FEW) {
            return nothing;
        }
        let n = kept.len();
        let sensitivities = Mat::from_fn(residual.len(), n, |i, k| own[kept[k]].0[i] / lengths[kept[k]]);
        let right = Mat::from_fn(residual.len(), 1, |i, _| -residual[i]);
        let ridge = if n > FEW { RIDGE } else { 0.0 };
        let gram =
            sensitivities.transpose() * &sensitivities + Mat::<f64>::identity(n, n) * faer::Scale(ridge);
        let Some(step) = solved(&gram, &(sensitivities.transpose() * right)) else { return nothing };
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
        let mut promise = CandidateScore { gain, resolution: 1.0 / lengths[kept[0]], scores, ..nothing };
        for (index, k) in kept.iter().enumerate() {
            let unit = Mat::from_fn(n, 1, |i, _| f64::from(i == index));
            let variance = solved(&gram, &unit).map_or(f64::INFINITY, |column| column[index]);
            promise.step[*k] = step[index] / lengths[*k];
            promise.std[*k] = variance.max(0.0).sqrt() / lengths[*k];
        }
        promise
    }
}

fn length(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Solution of a small symmetric system; `None` where it is singular.
fn solved(matrix: &Mat<f64>, right: &Mat<f64>) -> Option<Vec<f64>> {
    use faer::linalg::solvers::Solve;
    let llt = matrix.llt(faer::Side::Lower).ok()?;
    let solution = llt.solve(right);
    (0..matrix.nrows()).map(|k| Some(solution[(k, 0)]).filter(|value| value.is_finite())).collect()
}
