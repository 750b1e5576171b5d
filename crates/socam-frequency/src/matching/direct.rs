//! Fit of the same parameters to the frequency response, whose errors are known.

use nalgebra::{Complex, DMatrix, DVector};

use super::{bench::Bench, unknowns::UNKNOWNS};
use crate::{least_squares, rational::Point};

const MOST_STEPS: usize = 300;

/// Result of a direct fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Direct {
    /// Parameters, all positive.
    pub at: [f64; UNKNOWNS],
    /// Relative standard deviations; a large one means not determined.
    pub relative_std: [f64; UNKNOWNS],
    /// Relative standard deviation of the couplings' series stiffness.
    pub series_relative_std: f64,
    /// Root mean square residual in standard deviations of the points.
    pub misfit: f64,
    /// Whether the search converged.
    pub converged: bool,
}

/// Fits the bench's parameters to responses by Levenberg and Marquardt in their logarithms.
#[must_use]
pub fn direct(bench: &Bench, points: &[Point], start: &[f64; UNKNOWNS]) -> Direct {
    let mut logs = start.map(f64::ln);
    let mut damping = 1e-3;
    let (mut errors, mut slopes) = linearised(bench, points, &logs);
    let mut converged = false;
    for _ in 0..MOST_STEPS {
        let rows = slopes.nrows();
        let mut design = slopes.clone().insert_rows(rows, UNKNOWNS, 0.0);
        for j in 0..UNKNOWNS {
            design[(rows + j, j)] = (damping * slopes.column(j).norm_squared()).sqrt().max(1e-150);
        }
        let wanted = (-&errors).insert_rows(rows, UNKNOWNS, 0.0);
        let Ok(step) = least_squares::real(&design, &wanted, "a step") else { break };
        // Steps along undetermined directions may be arbitrarily large; they are limited to a factor of three.
        let step = step.map(|change| change.clamp(-1.1, 1.1));
        let cost = errors.norm_squared();
        let promised = cost - (&errors + &slopes * &step).norm_squared();
        if damping < 1e-3 && promised.abs() <= 1e-10 * cost + 1e-12 {
            converged = true;
            break;
        }
        let next: [f64; UNKNOWNS] = std::array::from_fn(|i| logs[i] + step[i]);
        let there = linearised(bench, points, &next);
        if there.0.norm_squared() < cost {
            logs = next;
            (errors, slopes) = there;
            damping = (damping / 10.0).max(1e-10);
        } else if damping > 1e10 {
            converged = true;
            break;
        } else {
            damping *= 10.0;
        }
    }
    report(points, &logs, &errors, &slopes, converged)
}

fn report(
    points: &[Point],
    logs: &[f64; UNKNOWNS],
    errors: &DVector<f64>,
    slopes: &DMatrix<f64>,
    converged: bool,
) -> Direct {
    let at = logs.map(f64::exp);
    let freedom = (2 * points.len()).saturating_sub(UNKNOWNS).max(1) as f64;
    let mean_square = 2.0 * errors.norm_squared() / freedom;
    let widened = 0.5 * mean_square.max(1.0);
    let decomposed = slopes.clone().svd(false, true);
    let covariance = |gradient: &DVector<f64>| {
        let Some(right) = &decomposed.v_t else { return f64::INFINITY };
        let largest = decomposed.singular_values.max();
        let part = |i: usize| {
            let share = right.row(i).transpose().dot(gradient);
            let size = decomposed.singular_values[i].max(1e-15 * largest);
            (share / size).powi(2)
        };
        (widened * (0..right.nrows()).map(part).sum::<f64>()).sqrt()
    };
    let unit = |index: usize| DVector::from_fn(UNKNOWNS, |i, _| f64::from(u8::from(i == index)));
    // d ln k_series = (k_series/k1) d ln k1 + (k_series/k2) d ln k2.
    let series = 1.0 / (1.0 / at[0] + 1.0 / at[1]);
    let of_series = DVector::from_fn(UNKNOWNS, |i, _| if i < 2 { series / at[i] } else { 0.0 });
    Direct {
        at,
        relative_std: std::array::from_fn(|i| covariance(&unit(i))),
        series_relative_std: covariance(&of_series),
        misfit: mean_square.sqrt(),
        converged,
    }
}

fn linearised(bench: &Bench, points: &[Point], logs: &[f64; UNKNOWNS]) -> (DVector<f64>, DMatrix<f64>) {
    let at = logs.map(f64::exp);
    let count = points.len();
    let mut errors = DVector::zeros(2 * count);
    let mut slopes = DMatrix::zeros(2 * count, UNKNOWNS);
    for (row, point) in points.iter().enumerate() {
        let s = Complex::new(0.0, std::f64::consts::TAU * point.frequency_hz);
        let (response, changes) = bench.response(&at, s);
        let error = (response * point.input - point.output) / point.std;
        (errors[row], errors[count + row]) = (error.re, error.im);
        for (column, change) in changes.iter().enumerate() {
            let change = change * point.input / point.std;
            (slopes[(row, column)], slopes[(count + row, column)]) = (change.re, change.im);
        }
    }
    (errors, slopes)
}
