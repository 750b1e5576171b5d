//! Weighted least squares of a parity residual, with standard errors and p-value.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// Least singular value of a regression with columns of length one.
const LEAST_SINGULAR: f64 = 1e-9;

/// A fit of a residual test.
#[derive(Debug, Clone)]
pub(super) struct ResidualFit {
    /// Coefficients of the model's free dampings, then of the explanation.
    pub(super) coefficients: Vec<f64>,
    /// Standard error of each coefficient.
    pub(super) std: Vec<f64>,
    /// Half-width of a 95 % interval in units of `std`.
    pub(super) quantile: f64,
    pub(super) chi2: f64,
    /// Chance of as large a chi-square by the readings' scatter alone.
    pub(super) p_value: f64,
    /// Residual at each point, in units of its uncertainty.
    pub(super) normalised: Vec<f64>,
    /// Residual at each point, in units of the error.
    pub(super) residual: Vec<f64>,
}

impl ResidualFit {
    /// The fit at these coefficients of the regression's columns. `rows` are the points that were fitted, by `free` coefficients.
    pub(super) fn new(
        (error, sigma): (&[f64], &[f64]),
        columns: &[&[f64]],
        (coefficients, std): (Vec<f64>, Vec<f64>),
        (rows, free): (&[usize], usize),
    ) -> Self {
        let model = |row: usize| columns.iter().zip(&coefficients).map(|(x, c)| x[row] * c).sum::<f64>();
        let residual: Vec<f64> = (0..error.len()).map(|row| error[row] - model(row)).collect();
        let normalised: Vec<f64> = residual.iter().zip(sigma).map(|(r, s)| r / s).collect();
        let chi2: f64 = rows.iter().map(|row| normalised[*row] * normalised[*row]).sum();
        let degrees = (rows.len() - free) as f64;
        let p_value = ChiSquared::new(degrees).map_or(1.0, |noise| noise.sf(chi2));
        // Where points scatter more than their uncertainty, intervals are widened by the scatter.
        let wider = if degrees > 0.0 { chi2 / degrees } else { 0.0 };
        let quantile = if wider > 1.0 {
            StudentsT::new(0.0, 1.0, degrees).map_or(1.96, |t| t.inverse_cdf(0.975)) * wider.sqrt()
        } else {
            1.96
        };
        Self { coefficients, std, quantile, chi2, p_value, normalised, residual }
    }
}

/// Coefficients of the columns and their standard errors, for `error` at the points `rows` with uncertainties `sigma`. `None` where the
/// points do not determine the coefficients.
pub(super) fn weighted(
    columns: &[&[f64]],
    rows: &[usize],
    error: impl Fn(usize) -> f64,
    sigma: &[f64],
) -> Option<(Vec<f64>, Vec<f64>)> {
    let matrix = DMatrix::from_fn(rows.len(), columns.len(), |i, j| columns[j][rows[i]] / sigma[rows[i]]);
    let right = DVector::from_fn(rows.len(), |i, _| error(rows[i]) / sigma[rows[i]]);
    // Columns are scaled to length one, so that their units do not matter.
    let lengths: Vec<f64> = (0..columns.len()).map(|j| matrix.column(j).norm()).collect();
    if lengths.iter().any(|length| !length.is_normal()) {
        return None;
    }
    let scaled = DMatrix::from_fn(rows.len(), columns.len(), |i, j| matrix[(i, j)] / lengths[j]);
    let svd = scaled.svd(true, true);
    if svd.singular_values.min() < LEAST_SINGULAR {
        return None;
    }
    let solution = svd.solve(&right, 0.0).ok()?;
    let v_t = svd.v_t.as_ref()?;
    let coefficients = (0..columns.len()).map(|j| solution[j] / lengths[j]);
    let std = (0..columns.len()).map(|j| {
        let each = (0..columns.len()).map(|s| v_t[(s, j)] / svd.singular_values[s]);
        each.map(|own| own * own).sum::<f64>().sqrt() / lengths[j]
    });
    Some((coefficients.collect(), std.collect()))
}
