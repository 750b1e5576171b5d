//! Small linear least squares by QR, columns scaled.

use nalgebra::{Complex, DMatrix, DVector};

use crate::FrequencyError;

/// Columns whose independent part is smaller than this fraction count as linearly dependent.
const RANK: f64 = 1e-12;

/// Solution of a complex problem, with residuals and a variance factor.
pub(crate) struct Solved {
    /// Unknowns x right-hand sides.
    pub(crate) unknowns: DMatrix<Complex<f64>>,
    /// Residuals, rows x right-hand sides.
    pub(crate) residuals: DMatrix<Complex<f64>>,
    /// Variance of the first unknown per variance of a row.
    pub(crate) first_variance: f64,
}

/// Least squares of several right-hand sides; `None` where the columns depend on each other.
pub(crate) fn complex(design: &DMatrix<Complex<f64>>, wanted: &DMatrix<Complex<f64>>) -> Option<Solved> {
    let scales: Vec<f64> = design.column_iter().map(|column| column.norm()).collect();
    if scales.iter().any(|scale| *scale <= 0.0 || !scale.is_finite()) {
        return None;
    }
    let scaled = DMatrix::from_fn(design.nrows(), design.ncols(), |i, j| design[(i, j)] / scales[j]);
    let factor = scaled.clone().qr();
    let (q, r) = (factor.q(), factor.r());
    if (0..r.ncols()).any(|j| r[(j, j)].norm() < RANK) {
        return None;
    }
    let projected = q.adjoint() * wanted;
    let solution = r.solve_upper_triangular(&projected)?;
    let residuals = wanted - &scaled * &solution;
    let identity = DMatrix::identity(r.ncols(), r.ncols());
    let inverse = r.solve_upper_triangular(&identity)?;
    let first_variance = inverse.row(0).iter().map(Complex::norm_sqr).sum::<f64>() / scales[0].powi(2);
    let unknowns = DMatrix::from_fn(solution.nrows(), solution.ncols(), |i, j| solution[(i, j)] / scales[i]);
    Some(Solved { unknowns, residuals, first_variance })
}

/// Least squares of one real right-hand side.
pub(crate) fn real(
    design: &DMatrix<f64>,
    wanted: &DVector<f64>,
    what: &'static str,
) -> Result<DVector<f64>, FrequencyError> {
    let scales: Vec<f64> = design.column_iter().map(|column| column.norm()).collect();
    let scaled = DMatrix::from_fn(design.nrows(), design.ncols(), |i, j| {
        if scales[j] > 0.0 { design[(i, j)] / scales[j] } else { 0.0 }
    });
    let factor = scaled.qr();
    let projected = factor.q().transpose() * wanted;
    let mut solution =
        factor.r().solve_upper_triangular(&projected).ok_or(FrequencyError::Singular { what })?;
    solution.iter_mut().zip(&scales).for_each(|(value, scale)| *value /= scale);
    if solution.iter().all(|value| value.is_finite()) {
        Ok(solution)
    } else {
        Err(FrequencyError::Singular { what })
    }
}
