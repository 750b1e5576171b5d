//! Start values by iterated linear least squares.

use nalgebra::{Complex, DMatrix, DVector};

use super::denominator::Denominator;
use super::descent;
use super::scaled::{Candidate, Scaled, real_rows};
use super::transfer::Orders;
use crate::FrequencyError;

type C = Complex<f64>;

/// Number of iterations; the weights converge in fewer or not at all.
const ROUNDS: usize = 25;

/// The iteration of Sanathanan and Koerner: A output - B input, divided by the last A.
pub(super) fn sanathanan_koerner(scaled: &Scaled<'_>, orders: Orders) -> Result<Candidate, FrequencyError> {
    let Orders { numerator, denominator } = orders;
    let mut weights = vec![1.0; scaled.points.len()];
    let mut best: Option<(f64, Candidate)> = None;
    for _ in 0..ROUNDS {
        let mut design =
            DMatrix::from_element(scaled.points.len(), numerator + denominator + 1, C::default());
        let mut wanted = DVector::from_element(scaled.points.len(), C::default());
        for (row, point) in scaled.points.iter().enumerate() {
            let (s, weight) = (scaled.s(row), weights[row] / point.std);
            for i in 0..denominator {
                design[(row, i)] = -point.output * s.powu(i as u32) * weight;
            }
            for i in 0..=numerator {
                design[(row, denominator + i)] = point.input * s.powu(i as u32) * weight;
            }
            wanted[row] = point.output * s.powu(denominator as u32) * weight;
        }
        let solution = match (real_rows(&design, &wanted), &best) {
            (Ok(solution), _) => solution,
            (Err(_), Some(_)) => break,
            (Err(error), None) => return Err(error),
        };
        let candidate = Candidate {
            denominator: Denominator::Coefficients(solution.as_slice()[..denominator].to_vec()),
            numerator: solution.as_slice()[denominator..].to_vec(),
        };
        let cost = descent::residuals(scaled, &candidate).norm_squared();
        for (row, weight) in weights.iter_mut().enumerate() {
            *weight = 1.0 / candidate.denominator.value(scaled.s(row)).0.norm().max(1e-300);
        }
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, candidate));
        }
    }
    best.map(|(_, candidate)| candidate).ok_or(FrequencyError::Singular { what: "the transfer function" })
}

/// The best numerator over a given denominator.
pub(super) fn numerator_for(
    scaled: &Scaled<'_>,
    denominator: Denominator,
    order: usize,
) -> Result<Candidate, FrequencyError> {
    let term = |row: usize, i: usize| {
        let (s, point) = (scaled.s(row), &scaled.points[row]);
        point.input * s.powu(i as u32) / denominator.value(s).0 / point.std
    };
    let design = DMatrix::from_fn(scaled.points.len(), order + 1, term);
    let wanted =
        DVector::from_fn(scaled.points.len(), |row, _| scaled.points[row].output / scaled.points[row].std);
    let solution = real_rows(&design, &wanted)?;
    Ok(Candidate { numerator: solution.as_slice().to_vec(), denominator })
}
