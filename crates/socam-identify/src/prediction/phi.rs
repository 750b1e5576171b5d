//! Exact response of one mode to an input that is a polynomial between its samples.

use nalgebra::Complex;

use crate::{Intersample, prediction::intersample};

type C = Complex<f64>;

/// One step of chi' = lambda chi + u: chi(k+1) = decay chi(k) + sum of taps times the input's coefficients about the interval. Each
/// factor comes with its derivative with respect to lambda.
#[derive(Debug, Clone)]
pub(crate) struct Hold {
    pub(crate) decay: C,
    pub(crate) decay_sensitivity: C,
    /// Tap and its derivative for each coefficient, the earliest first; see [`intersample::basis`].
    pub(crate) taps: Vec<(C, C)>,
}

impl Hold {
    /// `pole` in 1/s, `step_s` in s.
    pub(crate) fn new(pole: C, step_s: f64, intersample: Intersample) -> Self {
        let step = ModeStep::new(pole, step_s);
        let taps = intersample::basis(intersample).iter().map(|piece| step.response(piece)).collect();
        Self { decay: step.decay, decay_sensitivity: step.decay_sensitivity, taps }
    }
}

/// One step of chi' = lambda chi + u for an input that is any polynomial. Each factor comes with its derivative with respect to lambda.
#[derive(Debug, Clone)]
pub(crate) struct ModeStep {
    pub(crate) decay: C,
    pub(crate) decay_sensitivity: C,
    /// Responses to the powers of the position within the step, from 0 to 1.
    powers: [(C, C); 6],
}

impl ModeStep {
    /// `pole` in 1/s, `step_s` in s.
    pub(crate) fn new(pole: C, step_s: f64) -> Self {
        let x = pole * step_s;
        let decay = x.exp();
        let h = C::from(step_s);
        let phis = phis(x, decay);
        // Integral of exp(x (1 - s)) s^j over the step is j! phi_(j+1); phi_n' = phi_n - n phi_(n+1).
        let mut factorial = 1.0;
        let powers = std::array::from_fn(|j| {
            factorial *= j.max(1) as f64;
            let sensitivity = phis[j] - C::from((j + 1) as f64) * phis[j + 1];
            (h * phis[j] * factorial, h * h * sensitivity * factorial)
        });
        Self { decay, decay_sensitivity: h * decay, powers }
    }

    /// Response to the polynomial with these coefficients, lowest power first.
    pub(crate) fn response(&self, input: &[f64; 6]) -> (C, C) {
        let each =
            input.iter().zip(&self.powers).map(|(c, (value, sensitivity))| (value * c, sensitivity * c));
        each.fold((C::default(), C::default()), |sum, term| (sum.0 + term.0, sum.1 + term.1))
    }
}

/// phi_1 to phi_7: phi_1 = (e^x - 1)/x, phi_(n+1) = (phi_n - 1/n!)/x. Below |x| = 2 that recursion cancels digits, and the Taylor series
/// is summed instead.
fn phis(x: C, exp: C) -> [C; 7] {
    let mut phis = [C::default(); 7];
    if x.norm() > 2.0 {
        let (mut last, mut inverse_factorial) = (exp, 1.0);
        for (n, phi) in phis.iter_mut().enumerate() {
            last = (last - C::from(inverse_factorial)) / x;
            *phi = last;
            inverse_factorial /= (n + 1) as f64;
        }
        return phis;
    }
    for (n, phi) in phis.iter_mut().enumerate() {
        // x^j / (j + n + 1)!
        let mut term = C::from(1.0 / (1..=n + 1).map(|i| i as f64).product::<f64>());
        for j in 0..32 {
            *phi += term;
            term *= x / (j + n + 2) as f64;
        }
    }
    phis
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_form_meet() {
        for angle in [0.0, 1.0, 2.5, 3.1] {
            let inside = C::from_polar(2.0 - 1e-9, angle);
            let outside = C::from_polar(2.0 + 1e-9, angle);
            for (a, b) in phis(inside, inside.exp()).iter().zip(phis(outside, outside.exp())) {
                assert!((a - b).norm() < 1e-8, "{a} against {b}");
            }
        }
    }

    #[test]
    fn a_ramp_is_followed_exactly() {
        // chi' = -3 chi + t from rest: chi = t/3 - 1/9 + exp(-3 t)/9.
        for intersample in [Intersample::Linear, Intersample::BandLimited] {
            let hold = Hold::new(C::from(-3.0), 0.25, intersample);
            let margin = intersample::margin(intersample) as f64;
            let mut chi = C::default();
            for k in 0..8 {
                chi *= hold.decay;
                for (m, (tap, _)) in hold.taps.iter().enumerate() {
                    chi += tap * (f64::from(k) + m as f64 - margin) * 0.25;
                }
            }
            let exact = 2.0 / 3.0 - 1.0 / 9.0 + (-6.0_f64).exp() / 9.0;
            assert!((chi.re - exact).abs() < 1e-14);
        }
    }

    #[test]
    fn sensitivities_agree_with_differences() {
        for pole in [C::new(-3.0, 40.0), C::new(-9000.0, 0.0), C::new(-0.1, 0.0)] {
            let at = |pole: C| Hold::new(pole, 1e-3, Intersample::BandLimited);
            let step = C::from(1e-4 * pole.norm());
            let (more, here, less) = (at(pole + step), at(pole), at(pole - step));
            for m in 0..6 {
                let difference = (more.taps[m].0 - less.taps[m].0) / (step * 2.0);
                assert!((difference - here.taps[m].1).norm() < 1e-6 * here.taps[2].1.norm() + 1e-16);
            }
        }
    }
}
