//! Transfer functions and their orders.

use nalgebra::Complex;

use super::point::Point;
use crate::polynomial;

/// Orders of a transfer function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Orders {
    /// Highest power of the numerator.
    pub numerator: usize,
    /// Highest power of the denominator.
    pub denominator: usize,
}

impl std::fmt::Display for Orders {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.numerator, self.denominator)
    }
}

/// B(s)/A(s), coefficients ascending.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// B.
    pub numerator: Vec<f64>,
    /// A.
    pub denominator: Vec<f64>,
}

impl TransferFunction {
    /// Value at a complex frequency, 1/s.
    #[must_use]
    pub fn at(&self, s: Complex<f64>) -> Complex<f64> {
        polynomial::value(&self.numerator, s) / polynomial::value(&self.denominator, s)
    }

    /// Response at a frequency.
    #[must_use]
    pub fn response(&self, frequency_hz: f64) -> Complex<f64> {
        self.at(Complex::new(0.0, std::f64::consts::TAU * frequency_hz))
    }

    /// Simulated measurement of the response: `count` lines at equal ratios from the lowest to the highest frequency, with a
    /// relative standard deviation.
    #[must_use]
    pub fn measured(&self, [low_hz, high_hz]: [f64; 2], count: u32, relative_std: f64) -> Vec<Point> {
        let line = |i: u32| {
            let part = f64::from(i) / f64::from(count.max(2) - 1);
            let frequency_hz = low_hz * (high_hz / low_hz).powf(part);
            let output = self.response(frequency_hz);
            let (input, std) = (Complex::new(1.0, 0.0), relative_std * output.norm());
            Point { frequency_hz, input, output, std, freedom: f64::INFINITY }
        };
        (0..count).map(line).collect()
    }

    /// Roots of A, 1/s.
    #[must_use]
    pub fn poles(&self) -> Vec<Complex<f64>> {
        polynomial::roots(&self.denominator)
    }

    /// Roots of B, 1/s.
    #[must_use]
    pub fn zeros(&self) -> Vec<Complex<f64>> {
        polynomial::roots(&self.numerator)
    }

    /// Final value of the unit step response; meaningless if a pole is not stable.
    #[must_use]
    pub fn final_value(&self) -> f64 {
        self.numerator[0] / self.denominator[0]
    }
}
