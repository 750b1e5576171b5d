//! Least squares with variances from blocks of the recording: errors of neighbouring samples depend on one another, those of distant blocks
//! hardly (cluster-robust covariance: Liang and Zeger, Biometrika 73, 1986).

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Number of blocks into which a recording is divided.
const BLOCKS: usize = 40;

/// Largest share of a function's own power that one block may hold: a function that acts in one block alone has no variance between blocks.
const LARGEST_BLOCK: f64 = 0.25;

/// Coefficients with standard errors.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fit {
    pub(crate) coefficients: Vec<f64>,
    pub(crate) std: Vec<f64>,
    /// Share of the target's power that each regressor explains beside the others.
    pub(crate) shares: Vec<f64>,
    /// Share of the target's power that all regressors together explain.
    pub(crate) explained: f64,
}

/// Fits `target` by columns; rows with a value that is not finite are left out. `None` where columns are linearly dependent, or act in one
/// block alone.
pub(crate) fn fit(target: &[f64], columns: &[Vec<f64>]) -> Option<Fit> {
    let rows: Vec<usize> = (0..target.len())
        .filter(|row| target[*row].is_finite() && columns.iter().all(|column| column[*row].is_finite()))
        .collect();
    let (n, p) = (rows.len(), columns.len());
    if p == 0 || n < 4 * BLOCKS.max(p) {
        return None;
    }
    // Columns of size one, so that the matrix is as well conditioned as they are distinct.
    let size =
        |column: &Vec<f64>| (rows.iter().map(|row| column[*row].powi(2)).sum::<f64>() / n as f64).sqrt();
    let sizes: Vec<f64> = columns.iter().map(size).collect();
    if sizes.contains(&0.0) {
        return None;
    }
    let x = DMatrix::from_fn(n, p, |row, column| columns[column][rows[row]] / sizes[column]);
    let y = DVector::from_iterator(n, rows.iter().map(|row| target[*row]));
    let gram = x.tr_mul(&x);
    let inverse = gram.clone().cholesky().filter(|_| is_distinct(&gram))?.inverse();
    let b = &inverse * x.tr_mul(&y);
    let residual = &y - &x * &b;
    let is_spread = (0..p).all(|column| {
        // What a column has beside the others.
        let own = &x * inverse.column(column);
        let share = |block: usize| {
            own.rows(block * n / BLOCKS, (block + 1) * n / BLOCKS - block * n / BLOCKS).norm_squared()
        };
        (0..BLOCKS).map(share).fold(0.0, f64::max) < LARGEST_BLOCK * own.norm_squared()
    });
    if !is_spread {
        return None;
    }
    let mut meat = DMatrix::zeros(p, p);
    for block in 0..BLOCKS {
        let (from, to) = (block * n / BLOCKS, (block + 1) * n / BLOCKS);
        let score = x.rows(from, to - from).tr_mul(&residual.rows(from, to - from));
        meat += &score * score.transpose();
    }
    let factor = BLOCKS as f64 / (BLOCKS - 1) as f64;
    let covariance = &inverse * meat * &inverse * factor;
    let power = y.norm_squared().max(f64::MIN_POSITIVE);
    let std: Vec<f64> = (0..p).map(|k| covariance[(k, k)].max(0.0).sqrt() / sizes[k]).collect();
    let shares = (0..p).map(|k| b[k] * b[k] / inverse[(k, k)] / power).collect();
    let coefficients = (0..p).map(|k| b[k] / sizes[k]).collect();
    Some(Fit { coefficients, std, shares, explained: 1.0 - residual.norm_squared() / power })
}

/// Whether no column is nearly a combination of the others.
fn is_distinct(gram: &DMatrix<f64>) -> bool {
    let eigenvalues = gram.clone().symmetric_eigenvalues();
    eigenvalues.min() > 1e-6 * eigenvalues.max()
}

impl Fit {
    /// p-value of a coefficient.
    pub(crate) fn p_value(&self, index: usize) -> f64 {
        if self.std[index] == 0.0 {
            return if self.coefficients[index] == 0.0 { 1.0 } else { 0.0 };
        }
        let t = (self.coefficients[index] / self.std[index]).abs();
        2.0 * (1.0 - students(t))
    }

    /// Half-width of the 95 % interval.
    pub(crate) fn half_width(&self, index: usize) -> f64 {
        const QUANTILE: f64 = 2.022_69;
        QUANTILE * self.std[index]
    }
}

fn students(t: f64) -> f64 {
    StudentsT::new(0.0, 1.0, (BLOCKS - 1) as f64).map_or(0.5, |distribution| distribution.cdf(t))
}
