//! The data that a transfer function is fitted to.

use nalgebra::Complex;

use crate::response::Line;

/// One piece of data: A output = B input, within `std` of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Hz.
    pub frequency_hz: f64,
    /// What is put in; 1 where `output` is a response.
    pub input: Complex<f64>,
    /// What comes out.
    pub output: Complex<f64>,
    /// Root mean square of its complex error.
    pub std: f64,
    /// Complex degrees of freedom that `std` was estimated with, [`Line::freedom`]; infinite where it is known.
    pub freedom: f64,
}

impl Point {
    /// By how much more the coefficients' covariance has of this point than if `std` were known: a point whose noise is taken too small
    /// weighs too much (J. Schoukens et al., Automatica 33(6), 1997: (M - 2)/(M - 3) of M repetitions, which leave M - 1 degrees).
    pub(super) fn over_weighed(&self) -> f64 {
        1.0 + 1.0 / (self.freedom.max(3.0) - 2.0)
    }
}

impl From<&Line> for Point {
    fn from(line: &Line) -> Self {
        Self {
            frequency_hz: line.frequency_hz,
            input: Complex::new(1.0, 0.0),
            output: line.response,
            // The variance was itself estimated, with so many complex degrees of freedom: errors over its root scatter like Student's t.
            std: (line.variance / (1.0 - 1.0 / line.freedom.max(2.0))).sqrt(),
            freedom: line.freedom,
        }
    }
}
