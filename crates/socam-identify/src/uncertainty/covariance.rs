//! Covariance of the estimates: inverse information, sandwich estimate from scores by block, and a correction for noise in the
//! sensitivities.

use faer::{Mat, MatRef};
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::{
    evaluation::{self, SegmentEvaluation},
    matrix::{Svd, SymmetricEigen, gram, product},
    optimiser::qr,
    problem::Problem,
};

/// Smallest share of a direction's information that the errors-in-variables correction keeps: input noise in the sensitivities looks like
/// information.
const LEAST_INFORMATION: f64 = 0.02;
/// Singular values below this fraction of the largest are taken as zero.
const RANK_TOLERANCE: f64 = 1e-12;

/// Covariance W Q W' of the free parameters, SI, kept as factors: along a sloppy direction the entries of the product cancel to ten digits
/// and more.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Indices of the free parameters in the model.
    free: Vec<usize>,
    /// W W' is the inverse information.
    root: Mat<f64>,
    /// Q, the meat of the sandwich estimate; the identity for white residuals.
    meat: Mat<f64>,
    /// Half width of a 95 % interval in standard deviations.
    pub(crate) quantile: f64,
}

impl Uncertainty {
    /// Sandwich estimate from the scores by block, or the inverse information alone where blocks are few. `noise` is the part of
    /// the squared sensitivities that is input noise; it is subtracted from the information.
    pub(crate) fn new(
        problem: &Problem<'_>,
        point: &evaluation::Point,
        scales: &[f64],
        results: &[SegmentEvaluation],
        noise: &Mat<f64>,
    ) -> Self {
        let free = problem.free.len();
        let weights = evaluation::Weights::white(Vec::new(), scales.to_vec());
        let sizes = sizes(problem, &point.values, scales);
        let relative =
            |rows: &Mat<f64>| Mat::from_fn(rows.nrows(), free, |i, j| rows[(i, j)] * sizes[j] / scales[j]);
        let factor =
            relative(&crate::optimiser::factors::information_factor(problem, point, &weights, results));
        let Some(Directions { inverse, informed }) = Directions::of(&factor) else {
            return Self::unknown(problem);
        };
        let scores: Vec<Vec<Vec<f64>>> = results.iter().map(|result| profiled_scores(result, free)).collect();
        let blocks = scores.iter().map(Vec::len).sum::<usize>();
        let (meat, degrees) = if blocks >= 5 * free.max(2) {
            let correction = blocks as f64 / (blocks - free) as f64;
            let matrix =
                |rows: &Vec<Vec<f64>>| Mat::from_fn(rows.len(), free, |i, j| rows[i][j] * correction.sqrt());
            // Scores in coordinates of unit information.
            let white: Vec<Mat<f64>> =
                scores.iter().map(|segment| product(relative(&matrix(segment)), &inverse)).collect();
            let (spread, lag) = long_run_spread(&white, blocks);
            let prior = relative(&crate::optimiser::factors::prior_rows(problem, point, &weights));
            let mut meat = spread + gram(product(&prior, &inverse));
            // A direction without information has no scores; its variance ratio is set to one.
            (0..free).filter(|k| !informed[*k]).for_each(|k| meat[(k, k)] = meat[(k, k)].max(1.0));
            // Correlated blocks count for fewer degrees of freedom.
            (meat, (blocks - free) as f64 / (1.0 + 2.0 * lag as f64 / 3.0))
        } else {
            (Mat::identity(free, free), 1e6)
        };
        let quantile = StudentsT::new(0.0, 1.0, degrees).map_or(1.96, |t| t.inverse_cdf(0.975));
        let noise =
            Mat::from_fn(free, free, |i, j| noise[(i, j)] * (sizes[i] / scales[i]) * (sizes[j] / scales[j]));
        let noise = product(product(inverse.transpose(), &noise), &inverse);
        let inverse = Mat::from_fn(free, free, |i, k| inverse[(i, k)] * sizes[i]);
        let root = product(&inverse, errors_in_variables(&noise));
        Self { free: problem.free.clone(), root, meat, quantile }
    }

    /// Covariance for white residuals, from a factor over [free parameters, scaled | residual].
    pub(crate) fn white(problem: &Problem<'_>, values: &[f64], factor: &Mat<f64>, scales: &[f64]) -> Self {
        let free = problem.free.len();
        let sizes = sizes(problem, values, scales);
        let relative = Mat::from_fn(factor.nrows(), free, |i, j| factor[(i, j)] * sizes[j] / scales[j]);
        match Directions::of(&relative) {
            Some(directions) => Self {
                free: problem.free.clone(),
                root: Mat::from_fn(free, free, |i, k| directions.inverse[(i, k)] * sizes[i]),
                meat: Mat::identity(free, free),
                quantile: 1.96,
            },
            None => Self::unknown(problem),
        }
    }

    /// Standard deviation of a linear combination of free parameters, given as (index, coefficient).
    pub(crate) fn std(&self, sensitivities: &[(usize, f64)]) -> f64 {
        let white = self.whitened(sensitivities);
        let variance = self.product(&white, &white);
        // Rounding may give a small negative variance; NaN means overflow.
        if variance.is_nan() { f64::INFINITY } else { variance.max(0.0).sqrt() }
    }

    /// Half width of the 95 % interval of a function of the model's parameters, given its derivatives by their indices (the delta method).
    /// Parameters that were not estimated count as known.
    ///
    /// Breaks when the function bends much within the intervals of its parameters.
    #[must_use]
    pub fn half_width(&self, gradient: &[(usize, f64)]) -> f64 {
        let own = gradient.iter().filter_map(|(index, derivative)| {
            Some((self.free.iter().position(|free| free == index)?, *derivative))
        });
        self.quantile * self.std(&own.collect::<Vec<_>>())
    }

    /// Covariance without any information.
    fn unknown(problem: &Problem<'_>) -> Self {
        let free = problem.free.len();
        let root = Mat::from_fn(free, free, |i, j| if i == j { 1e150 } else { 0.0 });
        Self { free: problem.free.clone(), root, meat: Mat::identity(free, free), quantile: 1.96 }
    }

    pub(crate) fn covariance(&self, i: usize, j: usize) -> f64 {
        self.product(&self.whitened(&[(i, 1.0)]), &self.whitened(&[(j, 1.0)]))
    }

    fn whitened(&self, sensitivities: &[(usize, f64)]) -> Vec<f64> {
        let columns = 0..self.root.ncols();
        columns
            .map(|k| sensitivities.iter().map(|(i, sensitivity)| sensitivity * self.root[(*i, k)]).sum())
            .collect()
    }

    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        let pairs =
            a.iter().enumerate().flat_map(|(i, a)| b.iter().enumerate().map(move |(j, b)| (i, j, a * b)));
        pairs.map(|(i, j, weight)| weight * self.meat[(i, j)]).sum()
    }
}

/// Present magnitude of each free parameter; its scale where that is zero.
fn sizes(problem: &Problem<'_>, values: &[f64], scales: &[f64]) -> Vec<f64> {
    let size = |(index, scale): (&usize, &f64)| match values[*index].abs() {
        0.0 => *scale,
        size => size,
    };
    problem.free.iter().zip(scales).map(size).collect()
}

/// Parameter directions ordered by their information.
struct Directions {
    /// Columns are steps that change the residuals by one.
    inverse: Mat<f64>,
    /// Whether each direction has information.
    informed: Vec<bool>,
}

impl Directions {
    /// Computes it from a factor of the information matrix in relative steps; `None` if the factor has no singular values.
    fn of(factor: &Mat<f64>) -> Option<Self> {
        let free = factor.ncols();
        let svd = Svd::new(factor)?;
        let singular = |k: usize| svd.values[k].max(RANK_TOLERANCE * svd.values[0]).max(1e-150);
        Some(Self {
            inverse: Mat::from_fn(free, free, |i, k| svd.right[(i, k)] / singular(k)),
            informed: (0..free).map(|k| svd.values[k] > RANK_TOLERANCE * svd.values[0]).collect(),
        })
    }
}

/// Errors-in-variables correction (I - noise)^-1, where `noise` is the share of input noise in a unit information.
fn errors_in_variables(noise: &Mat<f64>) -> Mat<f64> {
    let size = noise.nrows();
    let identity = || Mat::<f64>::identity(size, size);
    let Some(SymmetricEigen { vectors, values }) = SymmetricEigen::new(noise) else { return identity() };
    let stretched =
        Mat::from_fn(size, size, |i, k| vectors[(i, k)] / (1.0 - values[k]).clamp(LEAST_INFORMATION, 1.0));
    product(&stretched, vectors.transpose())
}

/// Sum over blocks of score * score', correlations between neighbouring blocks included with Bartlett's weights up to
/// the lag of D. W. K. Andrews' rule (Econometrica 59, 1991), from the correlation of neighbouring blocks. Residuals of a drifting axis
/// stay correlated for seconds, those of sensor noise do not.
fn long_run_spread(white: &[Mat<f64>], blocks: usize) -> (Mat<f64>, usize) {
    let lagged = |lag: usize| {
        let free = white[0].ncols();
        white.iter().filter(|rows| rows.nrows() > lag).fold(Mat::<f64>::zeros(free, free), |sum, rows| {
            let count = rows.nrows() - lag;
            sum + product(rows.as_ref().subrows(0, count).transpose(), rows.as_ref().subrows(lag, count))
        })
    };
    let own = lagged(0);
    let trace = |m: &Mat<f64>| (0..m.nrows()).map(|i| m[(i, i)]).sum::<f64>();
    let correlation = (trace(&lagged(1)) / trace(&own)).clamp(-0.97, 0.97);
    let alpha = 4.0 * correlation.powi(2) / (1.0 - correlation.powi(2)).powi(2);
    let lag = ((1.1447 * (alpha * blocks as f64).cbrt()) as usize).min(blocks / 8);
    let spread = (1..=lag).fold(own, |sum, k| {
        let cross = lagged(k);
        sum + (&cross + cross.transpose()) * faer::Scale(1.0 - k as f64 / (lag + 1) as f64)
    });
    (spread, lag)
}

/// (R' R)⁻¹ through the singular values of R with its columns scaled to one; directions without information get an
/// enormous variance instead of an overflow.
pub(crate) fn inverse_information(factor: MatRef<'_, f64>) -> Mat<f64> {
    let free = factor.ncols();
    let norms = qr::lengths(factor, free);
    let scaled = Mat::from_fn(free, free, |i, j| factor[(i, j)] / norms[j]);
    let Some(Svd { values: s, right: v, .. }) = Svd::new(&scaled) else {
        return Mat::from_fn(free, free, |i, j| if i == j { 1e200 } else { 0.0 });
    };
    let least = RANK_TOLERANCE * if free > 0 && s[0] > 0.0 { s[0] } else { 1.0 };
    let root = Mat::from_fn(free, free, |i, k| v[(i, k)] / s[k].max(least) / norms[i]);
    product(&root, root.transpose())
}

/// Scores of the free parameters after elimination of the nuisance parameters: g - A' g_nuisance, A = R_nn⁻¹ R_ng.
fn profiled_scores(result: &SegmentEvaluation, free: usize) -> Vec<Vec<f64>> {
    let follow = nuisance_sensitivities(result, free);
    let each = result.scores.iter().map(|score| {
        let (local, global) = score.split_at(result.nuisance());
        let own = global.iter().enumerate();
        own.map(|(j, g)| g - local.iter().enumerate().map(|(i, l)| follow[(i, j)] * l).sum::<f64>()).collect()
    });
    each.collect()
}

/// Sensitivities of the nuisance parameters with respect to the free ones, with the sign of R_nn⁻¹ R_ng.
pub(crate) fn nuisance_sensitivities(result: &SegmentEvaluation, free: usize) -> Mat<f64> {
    let count = result.nuisance();
    let columns: Vec<Vec<f64>> =
        (0..free).map(|j| result.solve_nuisance(|row| result.factor[(row, count + j)])).collect();
    Mat::from_fn(count, free, |i, j| columns[j][i])
}
