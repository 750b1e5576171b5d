//! Ordinary least squares, and the result of every regression.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Result of a regression.
#[derive(Debug, Clone, PartialEq)]
pub struct Regression {
    /// One for each column of the design.
    pub coefficients: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Degrees of freedom of [`Self::residual_std`].
    pub degrees: f64,
    /// Standard deviation of the residuals, in the unit of the measured values.
    pub residual_std: f64,
    /// Rows that were left out, ascending.
    pub outliers: Vec<usize>,
    /// Contribution of each row's error to each coefficient; empty if all rows have equal variance.
    pub(super) shares: DMatrix<f64>,
    /// Number of rows from which the variance of one row is estimated.
    pub(super) together: f64,
}

impl Regression {
    /// Standard deviation of a coefficient.
    #[must_use]
    pub fn std(&self, index: usize) -> f64 {
        self.covariance[(index, index)].max(0.0).sqrt()
    }

    /// Standard deviation of sum of weight * coefficient.
    #[must_use]
    pub fn std_of(&self, weights: &[f64]) -> f64 {
        let weights = DVector::from_column_slice(weights);
        weights.dot(&(&self.covariance * &weights)).max(0.0).sqrt()
    }

    /// Satterthwaite's degrees of freedom of [`Self::std_of`]; they are few if few rows dominate.
    #[must_use]
    pub fn degrees_of(&self, weights: &[f64]) -> f64 {
        if self.shares.nrows() == 0 {
            return self.degrees;
        }
        let squares = (&self.shares * DVector::from_column_slice(weights)).map(|share| share * share);
        let (sum, largest) = (squares.sum(), squares.norm_squared());
        let total = self.std_of(weights).powi(2);
        if largest <= 0.0 || sum <= 0.0 {
            return self.degrees;
        }
        // Prior knowledge has infinite degrees of freedom; a row has at least as many as its variance was estimated from.
        let rows = (sum * sum / largest).max(1.0) * self.degrees / self.shares.nrows() as f64;
        (rows.max(self.together) * (total / sum).max(1.0).powi(2)).min(self.degrees)
    }

    /// Factor from a standard deviation to the half-width of a 95 % interval.
    #[must_use]
    pub fn quantile(&self) -> f64 {
        quantile95(self.degrees)
    }

    /// p-value of the F test that the coefficients `which` are zero.
    #[must_use]
    pub fn chance_of_none(&self, which: &[usize]) -> f64 {
        let n = which.len();
        let own = DVector::from_iterator(n, which.iter().map(|i| self.coefficients[*i]));
        let covariance = DMatrix::from_fn(n, n, |i, j| self.covariance[(which[i], which[j])]);
        let Some(inverse) = covariance.try_inverse() else { return 1.0 };
        let ratio = own.dot(&(inverse * &own)) / n as f64;
        statrs::distribution::FisherSnedecor::new(n as f64, self.degrees)
            .map_or(1.0, |f| f.sf(ratio.max(0.0)))
    }
}

/// Half-width of a 95 % interval in standard deviations, by Student's t.
#[must_use]
pub fn quantile95(degrees: f64) -> f64 {
    // The search for the quantile does not converge for very many degrees of freedom.
    StudentsT::new(0.0, 1.0, degrees.clamp(1.0, 1e4)).map_or(1.96, |t| t.inverse_cdf(0.975))
}

/// Ordinary least squares on all rows; `None` if they do not determine the coefficients.
#[must_use]
pub fn plain(design: &DMatrix<f64>, measured: &DVector<f64>) -> Option<Regression> {
    let all: Vec<usize> = (0..design.nrows()).collect();
    on(design, measured, &all)
}

/// Inverse of a symmetric matrix whose columns may differ by many orders of magnitude.
pub(super) fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    let sizes: Vec<f64> = (0..n).map(|i| matrix[(i, i)].sqrt()).collect();
    if sizes.iter().any(|size| !(*size > 0.0 && size.is_finite())) {
        return None;
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (sizes[i] * sizes[j]));
    let inverse = scaled.cholesky()?.inverse();
    // Larger entries belong to directions without information, where only rounding errors remain.
    let sane = (0..n).all(|i| inverse[(i, i)].is_finite() && inverse[(i, i)] < 1e13);
    sane.then(|| DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (sizes[i] * sizes[j])))
}

/// Least squares on some rows.
pub(super) fn on(design: &DMatrix<f64>, measured: &DVector<f64>, rows: &[usize]) -> Option<Regression> {
    let columns = design.ncols();
    if rows.len() <= columns {
        return None;
    }
    let own = design.select_rows(rows);
    let values = measured.select_rows(rows);
    let inverse = inverse(&(own.transpose() * &own))?;
    let coefficients = &inverse * (own.transpose() * &values);
    let residuals = &values - &own * &coefficients;
    let degrees = (rows.len() - columns) as f64;
    let variance = residuals.norm_squared() / degrees;
    Some(Regression {
        coefficients: coefficients.iter().copied().collect(),
        covariance: inverse * variance,
        degrees,
        residual_std: variance.sqrt(),
        outliers: Vec::new(),
        shares: DMatrix::zeros(0, columns),
        together: degrees,
    })
}
