//! The modes of a linear model: poles, eigenvectors and their inverse.

use faer::Mat;
use nalgebra::{Complex, DMatrix};

use crate::matrix::Eigen;

type C = Complex<f64>;

/// Least distance of two poles relative to the larger one. Derivatives of eigenvectors grow with its inverse.
const LEAST_GAP: f64 = 1e-7;
/// Largest condition number of the eigenvectors. Beyond it modal sensitivities lose half of their digits.
const MOST_SKEWED: f64 = 1e9;

/// One mode of each conjugate pair, and each real one.
pub(crate) struct Mode {
    pub(crate) index: usize,
    pub(crate) pole: C,
    /// 1 for a real mode, 2 for a pair.
    pub(crate) weight: f64,
    pub(crate) real: bool,
}

impl Mode {
    /// Number of real signals: real part, and imaginary part of a pair.
    pub(crate) fn signals(&self) -> usize {
        if self.real { 1 } else { 2 }
    }
}

/// Eigenvalues (1/s), eigenvectors and their inverse of a square matrix; `None` where it is close to defective.
pub(crate) fn diagonalise(matrix: &DMatrix<f64>) -> Option<(Vec<C>, DMatrix<C>, DMatrix<C>)> {
    let n = matrix.nrows();
    let scale = balance(matrix);
    let balanced = Mat::from_fn(n, n, |i, j| matrix[(i, j)] * scale[j] / scale[i]);
    let Eigen { values: poles, vectors } = Eigen::new(&balanced)?;
    // Two poles at zero (two free angles) differ by the rounding of the fastest pole.
    let rounding = 1e-13 * poles.iter().fold(0.0_f64, |most, pole| most.max(pole.norm()));
    for i in 0..n {
        for j in 0..i {
            let gap = (poles[i] - poles[j]).norm();
            if gap <= rounding + LEAST_GAP * poles[i].norm().max(poles[j].norm()) {
                return None;
            }
        }
    }
    let vectors = DMatrix::from_fn(n, n, |i, j| vectors[(i, j)]);
    let inverse = vectors.clone().try_inverse()?;
    let condition = vectors.norm() * inverse.norm();
    if condition.is_nan() || condition > MOST_SKEWED {
        return None;
    }
    let vectors = DMatrix::from_fn(n, n, |i, j| vectors[(i, j)] * scale[i]);
    let inverse = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / scale[j]);
    Some((poles, vectors, inverse))
}

/// Scales of the states, powers of two, that bring rows and columns to similar norms (balancing: Parlett and Reinsch 1969). States have
/// magnitudes from 1e-5 rad (twists) to 100 rad/s (speeds).
pub(crate) fn balance(matrix: &DMatrix<f64>) -> Vec<f64> {
    let n = matrix.nrows();
    let mut scale = vec![1.0; n];
    for _ in 0..20 {
        let mut done = true;
        for i in 0..n {
            let others = || (0..n).filter(|j| *j != i);
            let column: f64 = others().map(|j| (matrix[(j, i)] * scale[i] / scale[j]).abs()).sum();
            let row: f64 = others().map(|j| (matrix[(i, j)] * scale[j] / scale[i]).abs()).sum();
            if column > 0.0 && row > 0.0 {
                let factor = (row / column).sqrt().log2().round().exp2();
                done &= factor == 1.0;
                scale[i] *= factor;
            }
        }
        if done {
            break;
        }
    }
    scale
}

/// One mode of each conjugate pair, and each real one.
pub(crate) fn representatives(poles: &[C]) -> Vec<Mode> {
    let modes = poles.iter().enumerate().filter(|(_, pole)| pole.im >= 0.0);
    modes
        .map(|(index, pole)| {
            let real = pole.im == 0.0;
            Mode { index, pole: *pole, weight: if real { 1.0 } else { 2.0 }, real }
        })
        .collect()
}
