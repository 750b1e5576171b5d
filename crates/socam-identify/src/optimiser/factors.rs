//! Triangular factors of the free parameters: data, priors and weak log priors.

use faer::Mat;

use crate::{
    evaluation::{Point, SegmentEvaluation, Weights, squares},
    optimiser::qr,
    problem::Problem,
};

/// Factor from which steps are computed: [`information_factor`] and the weak log priors.
pub(crate) fn global_factor(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    evaluated: &[SegmentEvaluation],
) -> Mat<f64> {
    let information = information_factor(problem, point, weights, evaluated);
    let weak_priors = weak_prior_rows(problem, point, weights);
    let free = problem.free.len();
    qr::join([information.as_ref(), weak_priors.as_ref()].into_iter(), free + 1)
}

/// Factor from which intervals are computed: data and priors, without the weak log priors.
pub(crate) fn information_factor(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    results: &[SegmentEvaluation],
) -> Mat<f64> {
    let free = problem.free.len();
    let known = prior_rows(problem, point, weights);
    qr::join(results.iter().map(SegmentEvaluation::schur_complement).chain([known.as_ref()]), free + 1)
}

/// Weak log priors: a standard deviation of a factor of e about the model file's value. Along sloppy directions they select the point
/// nearest to the file's values. They move an estimate that the data determine to 10 % by a hundredth of its standard deviation, and
/// intervals leave them out.
fn weak_prior_rows(problem: &Problem<'_>, point: &Point, weights: &Weights) -> Mat<f64> {
    let free = problem.free.len();
    let mut rows = Mat::zeros(free, free + 1);
    for (j, index) in problem.free.iter().enumerate() {
        let parameter = &problem.model.parameters[*index];
        let (file, now) = (parameter.value, point.values[*index]);
        if parameter.prior.is_none() && parameter.bounds.0 >= 0.0 && file > 0.0 && now > 0.0 {
            rows[(j, j)] = weights.scales[j] / now;
            rows[(j, free)] = (now / file).ln();
        }
    }
    rows
}

pub(crate) fn prior_rows(problem: &Problem<'_>, point: &Point, weights: &Weights) -> Mat<f64> {
    let free = problem.free.len();
    let mut rows = Mat::zeros(free, free + 1);
    for (j, index) in problem.free.iter().enumerate() {
        if let Some(prior) = problem.model.parameters[*index].prior {
            rows[(j, j)] = weights.scales[j] / prior.std;
            rows[(j, free)] = (point.values[*index] - prior.value) / prior.std;
        }
    }
    rows
}

/// The cost: squared residuals, priors and weak log priors.
pub(crate) fn total_cost(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    evaluated: &[SegmentEvaluation],
) -> f64 {
    let size = |rows: Mat<f64>| rows.as_ref().col(problem.free.len()).squared_norm_l2();
    squares(evaluated)
        + size(prior_rows(problem, point, weights))
        + size(weak_prior_rows(problem, point, weights))
}

/// Unit of each free parameter in steps and factors: its magnitude.
pub(crate) fn scales(problem: &Problem<'_>, values: &[f64]) -> Vec<f64> {
    let scale = |index: &usize| {
        let parameter = &problem.model.parameters[*index];
        let range = parameter.bounds.1 - parameter.bounds.0;
        [
            values[*index].abs(),
            parameter.value.abs(),
            parameter.prior.map_or(0.0, |prior| prior.std),
            0.01 * range,
            1.0,
        ]
        .into_iter()
        .find(|scale| *scale > 0.0 && scale.is_finite())
        .unwrap_or(1.0)
    };
    problem.free.iter().map(scale).collect()
}
