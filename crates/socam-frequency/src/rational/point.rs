//! The data that a transfer function is fitted to.

use nalgebra::Complex;

use crate::response::Line;

/// A data point: A output = B input, with the standard deviation of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Hz.
    pub frequency_hz: f64,
    /// Input; 1 if `output` is a response.
    pub input: Complex<f64>,
    /// Output.
    pub output: Complex<f64>,
    /// Root mean square of its complex error.
    pub std: f64,
    /// Complex degrees of freedom that `std` was estimated with, [`Line::freedom`]; infinite where it is known.
    pub freedom: f64,
}

impl Point {
    /// Factor of the point's contribution to the covariance of the coefficients because `std` is estimated: points with underestimated noise
    /// weigh too much (J. Schoukens et al., Automatica 33(6), 1997: (M - 2)/(M - 3) for M repetitions with M - 1 degrees of freedom).
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
            // The variance is an estimate: errors over its root have the variance of Student's t.
            std: (line.variance / (1.0 - 1.0 / line.freedom.max(2.0))).sqrt(),
            freedom: line.freedom,
        }
    }
}
