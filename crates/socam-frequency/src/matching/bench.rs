//! The model transfer function of the thesis' bench, and the equations that match it to a measured one.

use nalgebra::Complex;

use super::programme::Equations;
use super::unknowns::UNKNOWNS;
use crate::{polynomial, rational::TransferFunction};

/// Known constants of the bench, in any consistent units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bench {
    /// Inertia of the cam shaft.
    pub cam_shaft: f64,
    /// Inertia of the disk.
    pub disk: f64,
    /// Inertia of the load.
    pub load: f64,
    /// Speed reduction.
    pub ratio: f64,
}

/// Coefficients of the model's P and Q, ascending, not normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// Coefficients of the numerator, s^0 to s^3.
    pub numerator: [f64; 4],
    /// Coefficients of the denominator, s^0 to s^6.
    pub denominator: [f64; 7],
}

impl Bench {
    /// P and Q at parameters in the order of [`super::NAMES`].
    #[must_use]
    pub fn coefficients(&self, at: &[f64; UNKNOWNS]) -> Coefficients {
        let [k1, k2, k3, k4, c2, c3, c4, c5] = *at;
        let n = self.ratio;
        let (first, second, third) = ([k1, c2], [k2, c3], [k4, c4]);
        let product = polynomial::product;
        // M s^2 + C s + K is tridiagonal, so that its determinant is a recursion.
        let coupling = |element: &[f64]| product(element, element);
        let motor_side = polynomial::sum(&first, &second);
        let cam_side = polynomial::sum(&second, &[k3 / (n * n), 0.0, self.cam_shaft + self.disk / (n * n)]);
        let disk_side = polynomial::sum(&third, &[k3]);
        let load_side = polynomial::sum(&third, &[0.0, c5, self.load]);
        let minus = |values: Vec<f64>| values.into_iter().map(|value| -value).collect::<Vec<f64>>();
        let two = polynomial::sum(&product(&cam_side, &motor_side), &minus(coupling(&second)));
        let three =
            polynomial::sum(&product(&disk_side, &two), &minus(product(&[(k3 / n).powi(2)], &motor_side)));
        let four = polynomial::sum(&product(&load_side, &three), &minus(product(&coupling(&third), &two)));
        let above = product(&product(&first, &second), &third);
        Coefficients {
            numerator: std::array::from_fn(|i| k3 * n * above.get(i).copied().unwrap_or(0.0)),
            denominator: std::array::from_fn(|i| n * n * four.get(i).copied().unwrap_or(0.0)),
        }
    }

    /// Derivatives of P and Q with respect to each parameter; exact, since both are affine in each.
    #[must_use]
    pub fn slopes(&self, at: &[f64; UNKNOWNS]) -> [Coefficients; UNKNOWNS] {
        std::array::from_fn(|index| {
            let size = if at[index] == 0.0 { 1.0 } else { at[index] };
            let (mut with, mut without) = (*at, *at);
            (with[index], without[index]) = (size, 0.0);
            let (with, without) = (self.coefficients(&with), self.coefficients(&without));
            Coefficients {
                numerator: std::array::from_fn(|i| (with.numerator[i] - without.numerator[i]) / size),
                denominator: std::array::from_fn(|i| (with.denominator[i] - without.denominator[i]) / size),
            }
        })
    }

    /// The model's transfer function from motor speed to load speed.
    #[must_use]
    pub fn transfer(&self, at: &[f64; UNKNOWNS]) -> TransferFunction {
        let Coefficients { numerator, denominator } = self.coefficients(at);
        TransferFunction { numerator: numerator.to_vec(), denominator: denominator.to_vec() }
    }

    /// Response at s, with derivatives with respect to the logarithm of each parameter.
    pub(crate) fn response(
        &self,
        at: &[f64; UNKNOWNS],
        s: Complex<f64>,
    ) -> (Complex<f64>, [Complex<f64>; UNKNOWNS]) {
        let here = self.coefficients(at);
        let (above, below) = (polynomial::value(&here.numerator, s), polynomial::value(&here.denominator, s));
        let slopes = self.slopes(at);
        let response = above / below;
        let change = |i: usize| {
            let rise = polynomial::value(&slopes[i].numerator, s);
            let fall = polynomial::value(&slopes[i].denominator, s);
            (rise - response * fall) / below * at[i]
        };
        (response, std::array::from_fn(change))
    }

    /// Equations that match a transfer function: the ten coefficients of P/Q with monic Q, each relative to the measured coefficient.
    /// The common scale of P and Q is free, so eq. 4.4d, which sets it, is left out; P(0)/Q(0) = 1/N is included.
    #[must_use]
    pub fn equations(&self, measured: &TransferFunction) -> BenchEquations {
        let leading = measured.denominator.get(6).copied().unwrap_or(1.0);
        let coefficient = |values: &[f64], i: usize| values.get(i).copied().unwrap_or(0.0) / leading;
        let numerator = (0..4).map(|i| coefficient(&measured.numerator, i));
        let denominator = (0..6).map(|i| coefficient(&measured.denominator, i));
        BenchEquations { bench: *self, targets: numerator.chain(denominator).collect() }
    }
}

/// Ten equations in the bench's parameters: s^0 to s^3 of the numerator, s^0 to s^5 of the denominator.
#[derive(Debug, Clone, PartialEq)]
pub struct BenchEquations {
    bench: Bench,
    targets: Vec<f64>,
}

impl BenchEquations {
    /// Name of each equation.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let numerator = (0..4).map(|i| format!("numerator s^{i}"));
        numerator.chain((0..6).map(|i| format!("denominator s^{i}"))).collect()
    }

    /// Coefficients of the model over the measured ones.
    #[must_use]
    pub fn ratios(&self, at: &[f64; UNKNOWNS]) -> Vec<f64> {
        self.normalised(at).iter().zip(&self.targets).map(|(value, target)| value / target).collect()
    }

    fn normalised(&self, at: &[f64; UNKNOWNS]) -> Vec<f64> {
        let Coefficients { numerator, denominator } = self.bench.coefficients(at);
        numerator.iter().chain(&denominator[..6]).map(|value| value / denominator[6]).collect()
    }
}

impl Equations for BenchEquations {
    fn count(&self) -> usize {
        self.targets.len()
    }

    fn errors(&self, at: &[f64; UNKNOWNS]) -> Vec<f64> {
        let values = self.normalised(at);
        values.iter().zip(&self.targets).map(|(value, target)| (value - target) / target.abs()).collect()
    }

    fn slopes(&self, at: &[f64; UNKNOWNS]) -> Vec<[f64; UNKNOWNS]> {
        let here = self.bench.coefficients(at);
        let slopes = self.bench.slopes(at);
        let leading = here.denominator[6];
        let of = |pick: &dyn Fn(&Coefficients) -> f64, target: f64| {
            std::array::from_fn(|i| {
                let share = pick(&here) / leading;
                (pick(&slopes[i]) - share * slopes[i].denominator[6]) / leading / target.abs()
            })
        };
        let numerator = (0..4).map(|i| of(&|c: &Coefficients| c.numerator[i], self.targets[i]));
        let denominator = (0..6).map(|i| of(&|c: &Coefficients| c.denominator[i], self.targets[4 + i]));
        numerator.chain(denominator).collect()
    }
}
