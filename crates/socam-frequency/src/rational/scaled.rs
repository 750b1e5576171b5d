//! Data and coefficients in scaled frequencies, so that all powers are of similar size.

use nalgebra::{Complex, DMatrix, DVector};

use super::{denominator::Denominator, point::Point};
use crate::{FrequencyError, least_squares};

type C = Complex<f64>;

/// The unit of frequencies, rad/s: their geometric mean, so that powers are of similar size.
pub(super) fn unit(points: &[Point]) -> f64 {
    let logs = points.iter().map(|point| point.frequency_hz.max(1e-12).ln());
    std::f64::consts::TAU * (logs.sum::<f64>() / points.len() as f64).exp()
}

/// Points with scaled frequencies.
pub(super) struct Scaled<'a> {
    pub(super) points: &'a [Point],
    /// rad/s.
    pub(super) unit: f64,
}

impl Scaled<'_> {
    pub(super) fn s(&self, index: usize) -> C {
        C::new(0.0, std::f64::consts::TAU * self.points[index].frequency_hz / self.unit)
    }
}

/// Numerator and denominator in scaled frequencies.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub(super) numerator: Vec<f64>,
    pub(super) denominator: Denominator,
}

/// Weighted linear least squares of complex rows as real ones.
pub(super) fn real_rows(design: &DMatrix<C>, wanted: &DVector<C>) -> Result<DVector<f64>, FrequencyError> {
    let rows = design.nrows();
    let split = |value: C, row: usize| if row < rows { value.re } else { value.im };
    let stacked = DMatrix::from_fn(2 * rows, design.ncols(), |i, j| split(design[(i % rows, j)], i));
    let right = DVector::from_fn(2 * rows, |i, _| split(wanted[i % rows], i));
    least_squares::real(&stacked, &right, "the transfer function")
}
