//! A fitted transfer function with standard deviations.

use nalgebra::{Complex, DMatrix, DVector};

use super::transfer::{Orders, TransferFunction};
use crate::polynomial::{self, Mode};

type C = Complex<f64>;

/// A mode with standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeEstimate {
    /// The mode.
    pub mode: Mode,
    /// Standard deviation of its natural frequency, Hz.
    pub frequency_std_hz: f64,
    /// Standard deviation of its damping ratio.
    pub damping_std: f64,
}

impl ModeEstimate {
    /// Whether its damping is significant; a real pole counts as damped.
    pub(super) fn is_damped(&self) -> bool {
        self.mode.pole.im == 0.0 || self.mode.damping_ratio.abs() > 1.96 * self.damping_std
    }
}

/// A fitted transfer function.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Orders of numerator and denominator.
    pub orders: Orders,
    /// A is monic.
    pub transfer: TransferFunction,
    /// Standard deviations of the numerator's coefficients, ascending.
    pub numerator_std: Vec<f64>,
    /// Standard deviations of the denominator's coefficients, the leading one 0.
    pub denominator_std: Vec<f64>,
    /// Modes, the slowest first.
    pub modes: Vec<ModeEstimate>,
    /// Standard deviation of the final value.
    pub final_value_std: f64,
    /// Mean square of normalised residuals; about 1 if the orders suffice.
    pub misfit: f64,
    /// Whether the descent converged.
    pub converged: bool,
    /// Rissanen's description length up to a constant; the least of several orders is advised.
    pub description_length: f64,
    pub(super) known: Known,
}

/// Coefficients in powers of `unit` with their covariance: denominator without its leading 1, then numerator.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Known {
    /// rad/s.
    pub(super) unit: f64,
    pub(super) denominator: Vec<f64>,
    pub(super) numerator: Vec<f64>,
    pub(super) covariance: DMatrix<f64>,
}

impl Fit {
    /// Standard deviations of the relative magnitude and of the phase, rad, of the response; valid if the orders suffice.
    #[must_use]
    pub fn response_std(&self, frequency_hz: f64) -> [f64; 2] {
        let Known { unit, denominator, numerator, covariance } = &self.known;
        let s = C::new(0.0, std::f64::consts::TAU * frequency_hz / unit);
        let (below, above) = (polynomial::value(denominator, s), polynomial::value(numerator, s));
        // Derivatives of ln B - ln A.
        let order = denominator.len() - 1;
        let slopes: Vec<C> = (0..order)
            .map(|i| -s.powu(i as u32) / below)
            .chain((0..numerator.len()).map(|i| s.powu(i as u32) / above))
            .collect();
        let std = |part: fn(&C) -> f64| {
            let gradient = DVector::from_iterator(slopes.len(), slopes.iter().map(part));
            gradient.dot(&(covariance * &gradient)).max(0.0).sqrt()
        };
        [std(|slope| slope.re), std(|slope| slope.im)]
    }
}
