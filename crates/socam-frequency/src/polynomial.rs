//! Polynomials with real coefficients.

use nalgebra::{Complex, DMatrix};

/// Value at a complex point; `coefficients` ascend.
#[must_use]
pub fn value(coefficients: &[f64], s: Complex<f64>) -> Complex<f64> {
    coefficients.iter().rev().fold(Complex::default(), |sum, c| sum * s + c)
}

/// Product.
#[must_use]
pub fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    if a.is_empty() || b.is_empty() {
        return Vec::new();
    }
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

/// Sum.
#[must_use]
pub fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    let at = |values: &[f64], i: usize| values.get(i).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|i| at(a, i) + at(b, i)).collect()
}

/// Roots, the smallest first; conjugate pairs stand together. Leading zeros are ignored.
#[must_use]
pub fn roots(coefficients: &[f64]) -> Vec<Complex<f64>> {
    let degree = coefficients.iter().rposition(|c| *c != 0.0).unwrap_or(0);
    if degree == 0 {
        return Vec::new();
    }
    let at_nought = coefficients.iter().position(|c| *c != 0.0).unwrap_or(0);
    let used = &coefficients[at_nought..=degree];
    let order = used.len() - 1;
    // In units of the roots' geometric mean, coefficients are of similar size.
    let unit = if order > 0 { (used[0] / used[order]).abs().powf(1.0 / order as f64) } else { 1.0 };
    let scaled: Vec<f64> = used.iter().enumerate().map(|(i, c)| c * unit.powi(i as i32)).collect();
    let companion = DMatrix::from_fn(order, order, |i, j| {
        if i == 0 { -scaled[order - 1 - j] / scaled[order] } else { f64::from(u8::from(i == j + 1)) }
    });
    let mut roots = vec![Complex::default(); at_nought];
    if order > 0 {
        roots.extend(companion.complex_eigenvalues().iter().map(|root| polished(&scaled, *root) * unit));
    }
    roots
        .sort_by(|a, b| (a.norm(), a.im).partial_cmp(&(b.norm(), b.im)).unwrap_or(std::cmp::Ordering::Equal));
    roots
}

/// Newton's method from an eigenvalue to the root.
fn polished(coefficients: &[f64], root: Complex<f64>) -> Complex<f64> {
    let slopes: Vec<f64> = coefficients.iter().enumerate().skip(1).map(|(i, c)| c * i as f64).collect();
    let mut at = root;
    for _ in 0..4 {
        let step = value(coefficients, at) / value(&slopes, at);
        if step.norm().is_nan() || step.norm() >= 1e-6 * (at.norm() + 1e-12) {
            break;
        }
        at -= step;
    }
    at
}

/// A second-order factor, or a first-order one, of a denominator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// The pole with positive imaginary part, or the real pole, 1/s.
    pub pole: Complex<f64>,
    /// Natural frequency, Hz.
    pub natural_frequency_hz: f64,
    /// Damping ratio; 1 for a stable real pole.
    pub damping_ratio: f64,
}

/// Modes of a denominator's roots, the slowest first.
#[must_use]
pub fn modes(poles: &[Complex<f64>]) -> Vec<Mode> {
    let one_of_each = poles.iter().filter(|pole| pole.im >= 0.0 || pole.im.abs() < 1e-9 * pole.norm());
    one_of_each
        .map(|pole| Mode {
            pole: *pole,
            natural_frequency_hz: pole.norm() / std::f64::consts::TAU,
            damping_ratio: if pole.norm() > 0.0 { -pole.re / pole.norm() } else { 1.0 },
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_a_product_are_the_factors_roots() {
        let factors =
            [vec![16104.425, 338.55, 1.0], vec![48463.2713, 120.56, 1.0], vec![718452.3737, 1596.88, 1.0]];
        let whole = factors.iter().fold(vec![1.0], |whole, factor| product(&whole, factor));
        let mut wanted: Vec<Complex<f64>> = factors.iter().flat_map(|factor| roots(factor)).collect();
        wanted.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        for (root, wanted) in roots(&whole).iter().zip(&wanted) {
            assert!((root.norm() - wanted.norm()).abs() < 1e-9 * wanted.norm(), "{root} {wanted}");
            assert!(value(&whole, *root).norm() < 1e-9 * whole[0]);
        }
        assert_eq!(roots(&[0.0, -2.0, 1.0]), vec![Complex::default(), Complex::new(2.0, 0.0)]);
        assert!(roots(&[3.0]).is_empty());
    }

    #[test]
    fn a_pair_is_one_mode_and_a_real_pole_another() {
        let modes = modes(&roots(&product(&[4.0, 0.4, 1.0], &[9.0, 1.0])));
        assert_eq!(modes.len(), 2);
        assert!((modes[0].damping_ratio - 0.1).abs() < 1e-12 && (modes[1].damping_ratio - 1.0).abs() < 1e-12);
    }
}
