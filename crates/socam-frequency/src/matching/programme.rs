//! Least squares of equations in positive unknowns, by sequential quadratic programmes.

use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus},
};
use nalgebra::{DMatrix, DVector};

use super::unknowns::UNKNOWNS;

const MOST_STEPS: usize = 2000;
/// Greatest relative decrease of an unknown in a step; all unknowns stay positive.
const MOST_REMOVED: f64 = 0.9;
/// Greatest relative increase of an unknown in a step.
const MOST_ADDED: f64 = 3.0;
/// Relative decrease of the cost in [`SLOW_STEPS`] steps below which the search has converged.
const SLOW_GAIN: f64 = 1e-9;
const SLOW_STEPS: usize = 25;
/// Cost below which the equations hold exactly.
const EXACT: f64 = 1e-26;
/// Errors of equations below this are rounding errors.
const ROUNDING: f64 = 1e-12;

/// Equations phi(x) = 0 in eight unknowns.
pub trait Equations {
    /// Number of equations.
    fn count(&self) -> usize;
    /// phi.
    fn errors(&self, at: &[f64; UNKNOWNS]) -> Vec<f64>;
    /// d phi / d x.
    fn slopes(&self, at: &[f64; UNKNOWNS]) -> Vec<[f64; UNKNOWNS]>;
}

/// Result of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct Matched {
    /// The unknowns, all positive.
    pub at: [f64; UNKNOWNS],
    /// Half the weighted sum of squares (eq. 4.9).
    pub cost: f64,
    /// Gradient of the cost (thesis after Table 4.5).
    pub gradient: [f64; UNKNOWNS],
    /// Gradient with respect to the logarithm of each unknown over twice the cost, which has no units. Zero if an unknown tends to
    /// zero.
    pub relative_gradient: [f64; UNKNOWNS],
    /// Greatest difference between this gradient and central differences of the cost, relative to its largest entry, less rounding errors;
    /// `None` if the equations hold to rounding.
    pub gradient_check: Option<f64>,
    /// Quadratic programmes solved.
    pub steps: usize,
    /// Whether the search converged before the greatest number of steps.
    pub converged: bool,
    /// Singular values of the weighted Jacobian with respect to the logarithms of the unknowns, largest first: a small one belongs to a
    /// combination that the equations hardly determine.
    pub singular_values: Vec<f64>,
}

/// Half the weighted sum of squares.
fn cost(equations: &dyn Equations, weights: &[f64], at: &[f64; UNKNOWNS]) -> f64 {
    equations.errors(at).iter().zip(weights).map(|(error, weight)| 0.5 * weight * error * error).sum()
}

/// Weighted errors and their Jacobian with respect to the logarithms of the unknowns.
fn linearised(
    equations: &dyn Equations,
    weights: &[f64],
    at: &[f64; UNKNOWNS],
) -> (DVector<f64>, DMatrix<f64>) {
    let roots: Vec<f64> = weights.iter().map(|weight| weight.sqrt()).collect();
    let errors = equations.errors(at);
    let slopes = equations.slopes(at);
    (
        DVector::from_fn(errors.len(), |i, _| roots[i] * errors[i]),
        DMatrix::from_fn(errors.len(), UNKNOWNS, |i, j| roots[i] * slopes[i][j] * at[j]),
    )
}

/// Minimises the weighted sum of squares over positive unknowns from a start.
#[must_use]
pub fn solve(equations: &dyn Equations, weights: &[f64], start: &[f64; UNKNOWNS]) -> Matched {
    let mut at = *start;
    let mut damping = 1e-3;
    let mut current = cost(equations, weights, &at);
    let (mut converged, mut steps) = (false, 0);
    let mut past = vec![current];
    while steps < MOST_STEPS {
        let (errors, slopes) = linearised(equations, weights, &at);
        steps += 1;
        let Some(step) = programme(&errors, &slopes, damping) else {
            damping *= 10.0;
            if damping > 1e10 {
                break;
            }
            continue;
        };
        let next: [f64; UNKNOWNS] = std::array::from_fn(|i| at[i] * (1.0 + step[i]));
        let there = cost(equations, weights, &next);
        if there < current {
            (at, current) = (next, there);
            damping = (damping / 5.0).max(1e-16);
            past.push(current);
        } else if damping > 1e10 {
            converged = true;
            break;
        } else {
            damping *= 4.0;
        }
        let slow =
            past.len() > SLOW_STEPS && past[past.len() - 1 - SLOW_STEPS] - current < SLOW_GAIN * current;
        if current < EXACT || slow {
            converged = true;
            break;
        }
    }
    report(equations, weights, &at, steps, converged)
}

fn report(
    equations: &dyn Equations,
    weights: &[f64],
    at: &[f64; UNKNOWNS],
    steps: usize,
    converged: bool,
) -> Matched {
    let (errors, slopes) = linearised(equations, weights, at);
    let cost = 0.5 * errors.norm_squared();
    let by_logarithm = slopes.transpose() * &errors;
    let exact = equations.errors(at).iter().all(|error| error.abs() < ROUNDING);
    let singular_values = slopes.singular_values().iter().copied().collect();
    Matched {
        at: *at,
        cost,
        gradient: std::array::from_fn(|i| by_logarithm[i] / at[i]),
        relative_gradient: std::array::from_fn(|i| if exact { 0.0 } else { by_logarithm[i] / (2.0 * cost) }),
        gradient_check: (!exact).then(|| gradient_check(equations, weights, at, by_logarithm.as_slice())),
        steps,
        converged,
        singular_values,
    }
}

/// Relative difference between the exact gradient and central differences of the cost.
fn gradient_check(equations: &dyn Equations, weights: &[f64], at: &[f64; UNKNOWNS], gradient: &[f64]) -> f64 {
    let step = 1e-5;
    let largest = gradient.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
    let worst = (0..UNKNOWNS).map(|i| {
        let moved = |share: f64| {
            let mut there = *at;
            there[i] *= 1.0 + share;
            cost(equations, weights, &there)
        };
        // Rounding of the cost limits the accuracy of the differences.
        let rounding = 1e-15 * cost(equations, weights, at) / step;
        ((moved(step) - moved(-step)) / (2.0 * step) - gradient[i]).abs() - rounding
    });
    let worst = worst.fold(0.0_f64, f64::max);
    if largest > 0.0 { worst / largest } else { 0.0 }
}

/// One quadratic programme: the relative steps within their limits that minimise the linearised errors.
fn programme(errors: &DVector<f64>, slopes: &DMatrix<f64>, damping: f64) -> Option<Vec<f64>> {
    // Columns and errors are scaled to unit norm for the solver.
    let norms: Vec<f64> = slopes.column_iter().map(|c| c.norm().max(1e-150)).collect();
    let size = errors.norm().max(1e-150);
    let scaled = DMatrix::from_fn(slopes.nrows(), UNKNOWNS, |i, j| slopes[(i, j)] / norms[j]);
    let curvature = scaled.transpose() * &scaled + DMatrix::identity(UNKNOWNS, UNKNOWNS) * damping;
    let linear: Vec<f64> = (scaled.transpose() * errors / size).iter().copied().collect();
    let upper: Vec<Vec<f64>> = (0..UNKNOWNS)
        .map(|i| (0..UNKNOWNS).map(|j| if j >= i { curvature[(i, j)] } else { 0.0 }).collect())
        .collect();
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    for i in 0..UNKNOWNS {
        let width = norms[i] / size;
        for (sign, limit) in [(1.0, MOST_ADDED), (-1.0, MOST_REMOVED)] {
            // Limits far beyond any step are left out, since they impair the scaling.
            if limit * width < 1e6 {
                let mut row = vec![0.0; UNKNOWNS];
                row[i] = sign;
                rows.push(row);
                right.push(limit * width);
            }
        }
    }
    if rows.is_empty() {
        rows.push(vec![0.0; UNKNOWNS]);
        right.push(1.0);
    }
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(rows.len())];
    let (p, a) = (CscMatrix::from(&upper), CscMatrix::from(&rows));
    let mut solver = DefaultSolver::new(&p, &linear, &a, &right, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    let steps = solver.solution.x.iter().zip(&norms);
    let steps: Vec<f64> = steps.map(|(z, norm)| (z * size / norm).clamp(-MOST_REMOVED, MOST_ADDED)).collect();
    (solved && steps.iter().all(|step| step.is_finite())).then_some(steps)
}
