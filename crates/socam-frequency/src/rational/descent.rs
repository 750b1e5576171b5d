//! Maximum likelihood by the method of Levenberg and Marquardt.

use nalgebra::{Complex, DMatrix, DVector};

use super::scaled::{Candidate, Scaled};
use crate::least_squares;

type C = Complex<f64>;

const MOST_STEPS: usize = 200;
/// Predicted relative decrease of the cost below which the search has converged.
const ENOUGH: f64 = 1e-12;

/// Result of a descent.
pub(super) struct Descent {
    pub(super) point: Candidate,
    pub(super) converged: bool,
}

/// (output - B/A input) / std, real parts first.
pub(super) fn residuals(scaled: &Scaled<'_>, at: &Candidate) -> DVector<f64> {
    linearised_with(scaled, at, false).0
}

/// Residuals and their Jacobian with respect to [denominator | numerator].
pub(super) fn linearised(scaled: &Scaled<'_>, at: &Candidate) -> (DVector<f64>, DMatrix<f64>) {
    linearised_with(scaled, at, true)
}

fn linearised_with(scaled: &Scaled<'_>, at: &Candidate, slopes: bool) -> (DVector<f64>, DMatrix<f64>) {
    let count = scaled.points.len();
    let poles = at.denominator.unknowns().len();
    let mut residuals = DVector::zeros(2 * count);
    let mut jacobian = DMatrix::zeros(if slopes { 2 * count } else { 0 }, poles + at.numerator.len());
    for (row, point) in scaled.points.iter().enumerate() {
        let s = scaled.s(row);
        let (below, changes) = at.denominator.value(s);
        let above = at.numerator.iter().rev().fold(C::default(), |sum, c| sum * s + c);
        let predicted = above / below * point.input;
        let error = (point.output - predicted) / point.std;
        (residuals[row], residuals[count + row]) = (error.re, error.im);
        if !slopes {
            continue;
        }
        let mut put = |column: usize, slope: C| {
            (jacobian[(row, column)], jacobian[(count + row, column)]) = (slope.re, slope.im);
        };
        for (column, change) in changes.iter().enumerate() {
            put(column, predicted / below * change / point.std);
        }
        for i in 0..at.numerator.len() {
            put(poles + i, -s.powu(i as u32) / below * point.input / point.std);
        }
    }
    (residuals, jacobian)
}

pub(super) fn descend(scaled: &Scaled<'_>, start: Candidate) -> Descent {
    let mut at = start;
    let mut damping = 1e-6;
    let (mut residual, mut slopes) = linearised(scaled, &at);
    let mut cost = residual.norm_squared();
    for _ in 0..MOST_STEPS {
        let columns = slopes.ncols();
        let rows = slopes.nrows();
        // Damping as additional rows, so that the condition number is not squared.
        let mut design = slopes.clone().insert_rows(rows, columns, 0.0);
        for j in 0..columns {
            design[(rows + j, j)] = (damping * slopes.column(j).norm_squared()).sqrt().max(1e-300);
        }
        let wanted = (-&residual).insert_rows(rows, columns, 0.0);
        let Ok(step) = least_squares::real(&design, &wanted, "a step") else {
            damping = (damping * 10.0).max(1e-12);
            if damping > 1e12 {
                break;
            }
            continue;
        };
        let promised = cost - (&residual + &slopes * &step).norm_squared();
        if promised <= ENOUGH * cost {
            return Descent { point: at, converged: true };
        }
        let poles = at.denominator.unknowns().len();
        let next = Candidate {
            denominator: at.denominator.moved(&step.as_slice()[..poles]),
            numerator: at.numerator.iter().zip(&step.as_slice()[poles..]).map(|(c, by)| c + by).collect(),
        };
        let there = residuals(scaled, &next).norm_squared();
        if there < cost {
            at = next;
            damping = (damping / 10.0).max(1e-15);
            (residual, slopes) = linearised(scaled, &at);
            cost = residual.norm_squared();
        } else if damping > 1e12 {
            break;
        } else {
            damping *= 10.0;
        }
    }
    Descent { point: at, converged: false }
}
