//! Standard deviations of a fitted transfer function.

use nalgebra::{Complex, DMatrix, DVector};

use super::denominator::Denominator;
use super::descent::{self, Descent};
use super::fit::{Fit, Known, ModeEstimate};
use super::scaled::{Candidate, Scaled};
use super::transfer::{Orders, TransferFunction};
use crate::FrequencyError;
use crate::polynomial::{self, Mode};

type C = Complex<f64>;

/// Singular values below this fraction of the largest are truncated.
const TRUNCATED: f64 = 1e-7;

pub(super) fn report(scaled: &Scaled<'_>, orders: Orders, best: &Descent) -> Result<Fit, FrequencyError> {
    let denominator = best.point.denominator.coefficients();
    let order = orders.denominator;
    // The covariance of the coefficients, whatever the parametrisation of the search.
    let coefficients = Candidate {
        numerator: best.point.numerator.clone(),
        denominator: Denominator::Coefficients(denominator[..order].to_vec()),
    };
    let (residuals, slopes) = descent::linearised(scaled, &coefficients);
    let freedom = (2 * scaled.points.len()).saturating_sub(slopes.ncols()).max(1) as f64;
    let misfit = 2.0 * residuals.norm_squared() / freedom;
    // Each residual's real part has half of the variance; a misfit above 1 widens all intervals.
    let widened = 0.5 * misfit.max(1.0);
    let root = root_of_inverse(&slopes)?;
    let mut directions = &slopes * &root;
    for (row, mut direction) in directions.row_iter_mut().enumerate() {
        direction *= scaled.points[row % scaled.points.len()].over_weighed().sqrt();
    }
    let covariance = &root * (directions.transpose() * &directions) * root.transpose() * widened;
    // Powers of the unit: a_i s^i of s^n.
    let scale = |power: usize| scaled.unit.powi(order as i32 - power as i32);
    let physical = |coefficients: &[f64]| -> Vec<f64> {
        coefficients.iter().enumerate().map(|(i, c)| c * scale(i)).collect()
    };
    let stds: Vec<f64> = (0..covariance.nrows()).map(|i| covariance[(i, i)].max(0.0).sqrt()).collect();
    let (a_std, b_std) = stds.split_at(order);
    let transfer =
        TransferFunction { numerator: physical(&best.point.numerator), denominator: physical(&denominator) };
    let (a0, b0) = (denominator[0], best.point.numerator[0]);
    let variance = covariance[(order, order)] / a0.powi(2) + covariance[(0, 0)] * (b0 / a0.powi(2)).powi(2)
        - 2.0 * covariance[(0, order)] * b0 / a0.powi(3);
    let count = (2 * scaled.points.len()) as f64;
    let unknowns = slopes.ncols() as f64;
    Ok(Fit {
        orders,
        modes: modes(&denominator, &covariance, scaled.unit),
        transfer,
        numerator_std: physical(b_std),
        denominator_std: [physical(a_std), vec![0.0]].concat(),
        final_value_std: variance.max(0.0).sqrt(),
        misfit,
        converged: best.converged,
        description_length: count * misfit.max(1e-300).ln() + unknowns * count.ln(),
        known: Known { unit: scaled.unit, denominator, numerator: best.point.numerator.clone(), covariance },
    })
}

/// R of (J^T J)^-1 = R R^T with small singular values truncated: if the orders are too high, a pole tends to infinity without effect on the
/// response, and its rounding errors would dominate.
fn root_of_inverse(slopes: &DMatrix<f64>) -> Result<DMatrix<f64>, FrequencyError> {
    let singular = FrequencyError::Singular { what: "the transfer function" };
    let scales: Vec<f64> = slopes.column_iter().map(|c| c.norm()).collect();
    if scales.contains(&0.0) {
        return Err(singular);
    }
    let scaled = DMatrix::from_fn(slopes.nrows(), slopes.ncols(), |i, j| slopes[(i, j)] / scales[j]);
    let decomposed = scaled.qr().r().svd(false, true);
    let (Some(right), sizes) = (decomposed.v_t, decomposed.singular_values) else { return Err(singular) };
    let kept: Vec<usize> = (0..sizes.len()).filter(|k| sizes[*k] > TRUNCATED * sizes.max()).collect();
    Ok(DMatrix::from_fn(right.ncols(), kept.len(), |j, k| right[(kept[k], j)] / (sizes[kept[k]] * scales[j])))
}

/// Modes, with standard deviations from the derivatives of the poles with respect to the coefficients.
fn modes(denominator: &[f64], covariance: &DMatrix<f64>, unit: f64) -> Vec<ModeEstimate> {
    let order = denominator.len() - 1;
    let slopes: Vec<f64> = denominator.iter().enumerate().skip(1).map(|(i, c)| c * i as f64).collect();
    let estimate = |mode: Mode| {
        let pole = mode.pole;
        let steep = polynomial::value(&slopes, pole);
        // dp = -sum da_i p^i / A'(p).
        let moves: Vec<C> = (0..order).map(|i| -pole.powu(i as u32) / steep).collect();
        let size = pole.norm();
        let frequency = DVector::from_fn(order, |i, _| (pole.conj() * moves[i]).re / size);
        let damping =
            DVector::from_fn(order, |i, _| -moves[i].re / size + pole.re * frequency[i] / size.powi(2));
        let part = covariance.view((0, 0), (order, order));
        let std = |gradient: &DVector<f64>| (gradient.transpose() * part * gradient)[(0, 0)].max(0.0).sqrt();
        ModeEstimate {
            mode: Mode {
                pole: pole * unit,
                natural_frequency_hz: mode.natural_frequency_hz * unit,
                damping_ratio: mode.damping_ratio,
            },
            frequency_std_hz: std(&frequency) * unit / std::f64::consts::TAU,
            damping_std: if pole.im == 0.0 { 0.0 } else { std(&damping) },
        }
    };
    polynomial::modes(&polynomial::roots(denominator)).into_iter().map(estimate).collect()
}
