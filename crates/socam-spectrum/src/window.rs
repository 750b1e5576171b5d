//! Windows that segments of a signal are weighted with, and what is taken off a segment before.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

/// Weights of the samples of a segment: what a window gains in level accuracy or in distance of side lobes it loses in resolution
/// (F. J. Harris, Proc. IEEE 66, 1978; flat top: the coefficients of SciPy and MATLAB).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Window {
    /// Raised cosine: side lobes fall fast; the usual choice.
    #[default]
    Hann,
    /// All weights are equal: finest resolution, for whole periods only; what is not periodic in the segment leaks.
    Rectangular,
    /// Level of a sine within 0.02 dB wherever it is between two lines; coarsest resolution.
    FlatTop,
    /// Side lobes below -58 dB, beside a main lobe that is wider than that of Hann's.
    Blackman,
}

impl Window {
    /// All windows.
    pub const ALL: [Self; 4] = [Self::Hann, Self::Rectangular, Self::FlatTop, Self::Blackman];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Hann => "Hann",
            Self::Rectangular => "rectangular",
            Self::FlatTop => "flat top",
            Self::Blackman => "Blackman",
        }
    }

    /// Amplitudes of the cosines of which it is the alternating sum.
    fn cosines(self) -> &'static [f64] {
        match self {
            Self::Hann => &[0.5, 0.5],
            Self::Rectangular => &[1.0],
            Self::FlatTop => &[0.215_578_95, 0.416_631_58, 0.277_263_158, 0.083_578_947, 0.006_947_368],
            Self::Blackman => &[0.42, 0.5, 0.08],
        }
    }

    /// The weights of `length` samples, symmetric about the middle.
    #[must_use]
    pub fn weights(self, length: usize) -> Vec<f64> {
        let turn = TAU / length.max(1) as f64;
        let weight = |k: usize| {
            let term = |(order, amplitude): (usize, &f64)| {
                let sign = if order % 2 == 0 { 1.0 } else { -1.0 };
                sign * amplitude * (order as f64 * turn * (k as f64 + 0.5)).cos()
            };
            self.cosines().iter().enumerate().map(term).sum()
        };
        (0..length).map(weight).collect()
    }
}

/// What is taken off a segment before it is weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Detrend {
    /// Nothing.
    Nothing,
    /// Its mean.
    #[default]
    Mean,
    /// The straight line that fits it best by least squares.
    Line,
}

impl Detrend {
    /// All choices.
    pub const ALL: [Self; 3] = [Self::Mean, Self::Line, Self::Nothing];

    /// What is taken off a signal: its value in the middle and its slope per sample.
    pub(crate) fn of(self, signal: &[f64]) -> [f64; 2] {
        let count = signal.len() as f64;
        let mean = || signal.iter().sum::<f64>() / count;
        match self {
            Self::Nothing => [0.0, 0.0],
            Self::Mean => [mean(), 0.0],
            Self::Line => {
                let middle = 0.5 * (count - 1.0);
                let moment: f64 =
                    signal.iter().enumerate().map(|(k, value)| (k as f64 - middle) * value).sum();
                // The sum of the squared distances of 0, 1, ... from their mean.
                let squares = count * (count * count - 1.0) / 12.0;
                [mean(), if squares > 0.0 { moment / squares } else { 0.0 }]
            }
        }
    }
}
