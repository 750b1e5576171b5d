//! Spectral radius, Lyapunov and Riccati equations, each by doubling.

use nalgebra::DMatrix;

use crate::noise::residual_noise::ResidualNoise;

/// Largest modulus of a matrix's eigenvalues, from the growth of its powers. Unlike an iteration for eigenvalues, this always ends.
pub(crate) fn spectral_radius(mut matrix: DMatrix<f64>) -> f64 {
    const DOUBLINGS: i32 = 24;
    let mut log_scale = 0.0;
    for _ in 0..DOUBLINGS {
        let size = matrix.norm();
        if size == 0.0 {
            return 0.0;
        }
        matrix /= size;
        log_scale = 2.0 * (log_scale + size.ln());
        matrix = &matrix * &matrix;
    }
    ((log_scale + matrix.norm().ln()) / 2.0_f64.powi(DOUBLINGS)).exp()
}

/// Solution X = A X A' + Q of a discrete Lyapunov equation: the sum of A^k Q A'^k. `None` where the sum does not converge.
pub(super) fn gramian(transition: &DMatrix<f64>, source: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    const DOUBLINGS: usize = 24;
    let (mut sum, mut power) = (source.clone(), transition.clone());
    for _ in 0..DOUBLINGS {
        let added = &power * &sum * power.transpose();
        sum += &added;
        if added.amax() <= 1e-14 * sum.amax() {
            break;
        }
        power = &power * &power;
    }
    sum.iter().all(|value| value.is_finite()).then_some(sum)
}

/// Stationary prediction covariance of the noise states: the solution of the filter's Riccati equation by the structure-preserving
/// doubling algorithm (Chu, Fan, Lin and Wang, International Journal of Control 77, 2004), which converges quadratically. `spread` is the
/// covariance of the outputs' noise. `None` where there is no stabilising solution.
pub(super) fn steady_covariance(noise: &ResidualNoise, spread: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = noise.transition.nrows();
    if n == 0 {
        return Some(DMatrix::zeros(0, 0));
    }
    let spread_inverse = spread.clone().try_inverse()?;
    let mut a = noise.transition.transpose();
    let mut g = noise.output.transpose() * &spread_inverse * &noise.output;
    let mut h = &noise.drive * noise.drive.transpose();
    for _ in 0..60 {
        let inner = (DMatrix::identity(n, n) + &g * &h).lu();
        let (wa, wg) = (inner.solve(&a)?, inner.solve(&g)?);
        let added = a.transpose() * &h * &wa;
        let next_g = &g + &a * wg * a.transpose();
        a = &a * wa;
        h += &added;
        h = (&h + h.transpose()) * 0.5;
        g = (&next_g + next_g.transpose()) * 0.5;
        if !h.iter().all(|value| value.is_finite()) {
            return None;
        }
        if added.amax() <= 1e-14 * h.amax() {
            return Some(h);
        }
    }
    None
}
