//! One step of a descent: damped least squares, or a quadratic programme where bounds and constraints are active; compliances instead of
//! stiffnesses for springs in series.

use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT},
};
use faer::{Mat, MatRef};

use crate::{
    evaluation::{Point, SegmentEvaluation, Weights},
    matrix::least_squares,
    optimiser::qr,
    problem::Problem,
    uncertainty::combinations,
};

/// Decrease of the cost by a step in scaled parameters that the linearisation predicts.
pub(crate) fn predicted_gain(factor: MatRef<'_, f64>, step: &[f64]) -> f64 {
    let free = step.len();
    let row = |i: usize| {
        let change: f64 = (i..free).map(|j| factor[(i, j)] * step[j]).sum();
        -change * (2.0 * factor[(i, free)] + change)
    };
    (0..free).map(row).sum()
}

/// The point after a step of the free parameters. Nuisance parameters follow, and take `share` of their own Gauss-Newton step.
pub(crate) fn moved(
    problem: &Problem<'_>,
    (point, weights, evaluated): (&Point, &Weights, &[SegmentEvaluation]),
    step: &[f64],
    share: f64,
) -> Point {
    let before = point.values.clone();
    let mut point = point.clone();
    for (j, index) in problem.free.iter().enumerate() {
        if step[j] == 0.0 {
            continue;
        }
        let bounds = problem.model.parameters[*index].bounds;
        let moved = coordinate(problem, *index).along(point.values[*index], step[j] * weights.scales[j]);
        point.values[*index] = moved.clamp(bounds.0, bounds.1);
    }
    carry_dampings(problem, &before, &weights.scales, step, &mut point.values);
    for (nuisance, result) in point.nuisance.iter_mut().zip(evaluated) {
        let (r, count) = (result.factor.as_ref(), result.nuisance());
        let change = result.solve_nuisance(|row| {
            let moved: f64 = step.iter().enumerate().map(|(j, s)| r[(row, count + j)] * s).sum();
            -moved - share * r[(row, count + step.len())]
        });
        nuisance.iter_mut().zip(change).for_each(|(local, change)| *local += change);
    }
    point
}

/// Adapts the damping of springs in series. In series, compliances 1/k add, and so do the terms c/k^2. When the stiffness of a
/// spring changes, its damping is changed such that steps are linear in c/k^2.
fn carry_dampings(problem: &Problem<'_>, before: &[f64], scales: &[f64], step: &[f64], values: &mut [f64]) {
    let change = |index: usize| {
        let position = problem.free.iter().position(|free| *free == index)?;
        Some(step[position] * scales[position])
    };
    for spring in &problem.model.springs {
        let Some(damping) = spring.damping else { continue };
        let straight = coordinate(problem, spring.stiffness) == Reparametrisation::Straight;
        let (Some(stiffer), Some(more), false) = (change(spring.stiffness), change(damping), straight) else {
            continue;
        };
        let (k, c) = (before[spring.stiffness], before[damping]);
        let moved = (c + more - 2.0 * c * stiffer / k) * (values[spring.stiffness] / k).powi(2);
        let bounds = problem.model.parameters[damping].bounds;
        values[damping] = moved.clamp(0.1 * c, 10.0 * c.max(1e-12)).clamp(bounds.0, bounds.1);
    }
}

/// The coordinate in which steps of a parameter are linear.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Reparametrisation {
    /// The parameter itself.
    Straight,
    /// The inverse of the parameter. The sloppy direction of two stiffnesses in series is a straight line in compliances and a
    /// hyperbola in stiffnesses, along which linear steps are short.
    Inverse,
}

pub(crate) fn coordinate(problem: &Problem<'_>, index: usize) -> Reparametrisation {
    let free = |index: usize| problem.free.contains(&index);
    // A single spring has no sloppy direction, and the model is more linear in its stiffness.
    let in_series = combinations::pairs(problem.model).any(|(a, b)| {
        (a.stiffness == index || b.stiffness == index) && free(a.stiffness) && free(b.stiffness)
    });
    let tied =
        problem.options.constraints.iter().any(|c| c.terms.iter().any(|(parameter, _)| *parameter == index));
    if in_series && !tied { Reparametrisation::Inverse } else { Reparametrisation::Straight }
}

impl Reparametrisation {
    /// Value after a step whose tangent is `change`.
    fn along(self, value: f64, change: f64) -> f64 {
        match self {
            Self::Straight => value + change,
            Self::Inverse => value / (1.0 - change / value),
        }
    }

    /// Ends of an interval that is symmetric in the coordinate; `half` is its half width in the tangent.
    pub(crate) fn interval(self, value: f64, half: f64) -> [f64; 2] {
        match self {
            Self::Straight => [value - half, value + half],
            Self::Inverse => {
                let part = half / value.abs();
                let far = if part < 1.0 { value / (1.0 - part) } else { f64::INFINITY };
                [value / (1.0 + part), far]
            }
        }
    }

    /// Tangent step from `value` to `target`.
    fn towards(self, value: f64, target: f64) -> f64 {
        match self {
            Self::Straight => target - value,
            Self::Inverse => value - value * value / target,
        }
    }
}

/// Step in scaled parameters within bounds and constraints; parameters that cannot change sign move by a factor of ten at most.
pub(crate) fn constrained_step(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    factor: MatRef<'_, f64>,
    damping: f64,
) -> Option<Vec<f64>> {
    let free = problem.free.len();
    let norms = qr::lengths(factor, free);
    let limits: Vec<(f64, f64)> = problem
        .free
        .iter()
        .enumerate()
        .map(|(j, index)| {
            let (value, bounds, scale) =
                (point.values[*index], problem.model.parameters[*index].bounds, weights.scales[j]);
            let reach = value.abs().max(0.1 * scale);
            let near = if bounds.0 >= 0.0 {
                (value - 0.9 * reach, value + 9.0 * reach)
            } else {
                (f64::NEG_INFINITY, f64::INFINITY)
            };
            let coordinate = coordinate(problem, *index);
            let limit = |target: f64| coordinate.towards(value, target) / scale;
            (limit(bounds.0.max(near.0)), limit(bounds.1.min(near.1)))
        })
        .collect();
    if problem.options.constraints.is_empty() {
        let step = damped_step(factor, &norms, damping);
        let inside = step.iter().zip(&limits).all(|(s, (low, high))| s >= low && s <= high);
        if inside {
            return Some(step);
        }
    }
    // The quadratic programme squares the condition number and may need more damping.
    let dampings = [0.0, 1e-12, 1e-10, 1e-8, 1e-6].map(|least| damping.max(least));
    dampings
        .iter()
        .find_map(|damping| quadratic_programme(problem, point, weights, factor, &norms, *damping, &limits))
}

/// Least squares of [R; sqrt(damping) diag(norms)] step = -[r; 0] by QR.
fn damped_step(factor: MatRef<'_, f64>, norms: &[f64], damping: f64) -> Vec<f64> {
    let free = norms.len();
    // Columns are normalised for the rank decision.
    let matrix = Mat::from_fn(2 * free, free, |i, j| {
        if i < free {
            factor[(i, j)] / norms[j]
        } else if i - free == j {
            damping.sqrt()
        } else {
            0.0
        }
    });
    let right = Mat::from_fn(2 * free, 1, |i, _| if i < free { -factor[(i, free)] } else { 0.0 });
    let (step, _) = least_squares(matrix, &right);
    (0..free).map(|j| step[(j, 0)] / norms[j]).collect()
}

fn quadratic_programme(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    factor: MatRef<'_, f64>,
    norms: &[f64],
    damping: f64,
    limits: &[(f64, f64)],
) -> Option<Vec<f64>> {
    let free = norms.len();
    // Unknowns z = norm * step give a Hessian of unit diagonal. The gradient is scaled to one.
    let hessian = |i: usize, j: usize| {
        let product: f64 = (0..=i.min(j)).map(|k| factor[(k, i)] * factor[(k, j)]).sum();
        product / (norms[i] * norms[j]) + if i == j { damping } else { 0.0 }
    };
    let gradient: Vec<f64> = (0..free)
        .map(|j| (0..=j).map(|k| factor[(k, j)] * factor[(k, free)]).sum::<f64>() / norms[j])
        .collect();
    let size = gradient.iter().fold(1e-300_f64, |m, g| m.max(g.abs()));
    let q: Vec<f64> = gradient.iter().map(|g| g / size).collect();
    let upper: Vec<Vec<f64>> =
        (0..free).map(|i| (0..free).map(|j| if i <= j { hessian(i, j) } else { 0.0 }).collect()).collect();
    let Inequalities { equalities, rows } = Inequalities::of(problem, point, weights, norms, limits, size);
    // Equalities come first, in the zero cone.
    let cones = [ZeroConeT(equalities.len()), NonnegativeConeT(rows.len())];
    let (dense, right): (Vec<Vec<f64>>, Vec<f64>) = equalities.into_iter().chain(rows).unzip();
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let (p, a) = (CscMatrix::from(&upper), CscMatrix::from(&dense));
    let mut solver = DefaultSolver::new(&p, &q, &a, &right, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    solved.then(|| {
        let steps = solver.solution.x.iter().zip(norms).zip(limits);
        steps.map(|((z, norm), (low, high))| (z * size / norm).clamp(*low, *high)).collect()
    })
}

/// Rows a z <= b of a quadratic programme, and equalities a z = b, in unknowns z = norm * step / size.
struct Inequalities {
    equalities: Vec<(Vec<f64>, f64)>,
    rows: Vec<(Vec<f64>, f64)>,
}

impl Inequalities {
    /// Collects the inequalities from the limits of each step and the constraints of the problem.
    fn of(
        problem: &Problem<'_>,
        point: &Point,
        weights: &Weights,
        norms: &[f64],
        limits: &[(f64, f64)],
        size: f64,
    ) -> Self {
        let free = norms.len();
        let mut equalities: Vec<(Vec<f64>, f64)> = Vec::new();
        let mut rows: Vec<(Vec<f64>, f64)> = Vec::new();
        for (j, (low, high)) in limits.iter().enumerate() {
            for (sign, limit) in [(1.0, *high), (-1.0, -*low)] {
                if limit.is_finite() {
                    let mut row = vec![0.0; free];
                    row[j] = sign;
                    rows.push((row, limit * norms[j] / size));
                }
            }
        }
        for constraint in &problem.options.constraints {
            let now: f64 = constraint.terms.iter().map(|(index, c)| c * point.values[*index]).sum();
            for (sign, limit) in [(1.0, constraint.upper - now), (-1.0, now - constraint.lower)] {
                let mut row = vec![0.0; free];
                for (index, c) in &constraint.terms {
                    if let Some(j) = problem.free.iter().position(|free| free == index) {
                        row[j] += sign * c * weights.scales[j] / norms[j];
                    }
                }
                let length = row.iter().map(|r| r * r).sum::<f64>().sqrt();
                if limit.is_finite() && length > 0.0 {
                    let row = (row.iter().map(|r| r / length).collect(), limit / (length * size));
                    match (constraint.lower == constraint.upper, sign > 0.0) {
                        (true, true) => equalities.push(row),
                        (true, false) => {}
                        (false, _) => rows.push(row),
                    }
                }
            }
        }
        Self { equalities, rows }
    }
}
