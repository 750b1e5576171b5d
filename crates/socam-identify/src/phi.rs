//! Exact response of one mode to an input that is linear between samples.

use nalgebra::Complex;

type C = Complex<f64>;

/// One step of chi' = lambda chi + u: chi(k+1) = decay chi(k) + before u(k) + after u(k+1), and the derivatives
/// of all three with respect to lambda.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hold {
    pub(crate) decay: C,
    pub(crate) before: C,
    pub(crate) after: C,
    pub(crate) decay_slope: C,
    pub(crate) before_slope: C,
    pub(crate) after_slope: C,
}

impl Hold {
    /// `pole` in 1/s, `step_s` in s.
    pub(crate) fn new(pole: C, step_s: f64) -> Self {
        let x = pole * step_s;
        let decay = x.exp();
        let (phi1, phi2, slope1, slope2) = phi(x, decay);
        let h = C::from(step_s);
        Self {
            decay,
            before: h * (phi1 - phi2),
            after: h * phi2,
            decay_slope: h * decay,
            before_slope: h * h * (slope1 - slope2),
            after_slope: h * h * slope2,
        }
    }
}

/// phi1 = (e^x - 1)/x, phi2 = (phi1 - 1)/x and their derivatives; Taylor near zero, where these cancel.
fn phi(x: C, exp: C) -> (C, C, C, C) {
    let one = C::from(1.0);
    if x.norm() > 1.0 {
        let phi1 = (exp - one) / x;
        let phi2 = (phi1 - one) / x;
        let slope1 = (exp - phi1) / x;
        return (phi1, phi2, slope1, (slope1 - phi2) / x);
    }
    let (mut phi1, mut phi2, mut slope1, mut slope2) =
        (C::default(), C::default(), C::default(), C::default());
    let mut power = one;
    let mut factorial = 1.0;
    for j in 0..20 {
        let n = f64::from(j);
        // power = x^j, factorial = (j + 1)!
        phi1 += power / factorial;
        phi2 += power / (factorial * (n + 2.0));
        slope1 += power * (n + 1.0) / (factorial * (n + 2.0));
        slope2 += power * (n + 1.0) / (factorial * (n + 2.0) * (n + 3.0));
        power *= x;
        factorial *= n + 2.0;
    }
    (phi1, phi2, slope1, slope2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_form_meet() {
        for angle in [0.0, 1.0, 2.5, 3.1] {
            let inside = C::from_polar(1.0 - 1e-9, angle);
            let outside = C::from_polar(1.0 + 1e-9, angle);
            let (a, b) = (phi(inside, inside.exp()), phi(outside, outside.exp()));
            for (a, b) in [(a.0, b.0), (a.1, b.1), (a.2, b.2), (a.3, b.3)] {
                assert!((a - b).norm() < 1e-8, "{a} against {b}");
            }
        }
        let (phi1, phi2, slope1, slope2) = phi(C::default(), C::from(1.0));
        for (got, want) in [(phi1, 1.0), (phi2, 0.5), (slope1, 0.5), (slope2, 1.0 / 6.0)] {
            assert!((got - C::from(want)).norm() < 1e-15);
        }
    }

    #[test]
    fn a_ramp_is_followed_exactly() {
        // chi' = -3 chi + t from rest: chi = t/3 - 1/9 + exp(-3 t)/9.
        let hold = Hold::new(C::from(-3.0), 0.25);
        let mut chi = C::default();
        for k in 0..8 {
            let t = f64::from(k) * 0.25;
            chi = hold.decay * chi + hold.before * t + hold.after * (t + 0.25);
        }
        let exact = 2.0 / 3.0 - 1.0 / 9.0 + (-6.0_f64).exp() / 9.0;
        assert!((chi.re - exact).abs() < 1e-14);
    }
}
