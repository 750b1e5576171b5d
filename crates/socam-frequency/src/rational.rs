//! Transfer functions fitted to data over frequency.
//!
//! B(s)/A(s) starts from the iteration of Sanathanan and Koerner and ends at the maximum of the likelihood (Levenberg and
//! Marquardt), so that coefficients, modes and the final value have standard deviations.

mod denominator;
mod descent;
mod fit;
mod point;
mod report;
mod scaled;
mod start;
mod transfer;

pub use fit::{Fit, ModeEstimate};
pub use point::Point;
pub use transfer::{Orders, TransferFunction};

use crate::FrequencyError;
use report::report;
use scaled::{Scaled, unit};

/// Highest order of a denominator.
pub const MOST: usize = 12;

/// Difference of description length from the best one above which a transfer function has no weight (weights are the exponential of
/// minus half of the difference).
const MOST_DIFFERENCE: f64 = 20.0;

/// Fits a transfer function of given orders to points.
///
/// With `stable`, all poles are in the left half plane: unstable poles of a free fit are mirrored, and a fit of stable transfer functions
/// starts there.
///
/// # Errors
/// [`FrequencyError::Orders`], [`FrequencyError::TooFewLines`], or [`FrequencyError::Singular`] where the data do not determine the
/// coefficients at all.
pub fn fit(points: &[Point], orders: Orders, stable: bool) -> Result<Fit, FrequencyError> {
    let Orders { numerator, denominator } = orders;
    if numerator > denominator || !(1..=MOST).contains(&denominator) {
        return Err(FrequencyError::Orders { numerator, denominator });
    }
    let unknowns = numerator + denominator + 1;
    if 2 * points.len() <= unknowns {
        return Err(FrequencyError::TooFewLines { lines: points.len(), unknowns });
    }
    let unit = unit(points);
    let scaled = Scaled { points, unit };
    let first = start::sanathanan_koerner(&scaled, orders)?;
    let free = descent::descend(&scaled, first);
    let best = if stable && !free.point.denominator.is_stable() {
        let mirrored = free.point.denominator.mirrored();
        descent::descend(&scaled, start::numerator_for(&scaled, mirrored, numerator)?)
    } else {
        free
    };
    report(&scaled, orders, &best)
}

/// Fits all orders up to `most`, numerators of order 0 to one less than the denominator; the best first.
#[must_use]
pub fn advise(points: &[Point], most: usize, stable: bool) -> Vec<Fit> {
    let mut fits: Vec<Fit> = (1..=most.min(MOST))
        .flat_map(|denominator| (0..denominator).map(move |numerator| Orders { numerator, denominator }))
        .filter_map(|orders| fit(points, orders, stable).ok())
        .collect();
    fits.sort_by(|a, b| a.description_length.total_cmp(&b.description_length));
    // A narrow resonance between two lines can always fit the noise of one of them; fits with undamped modes are therefore excluded.
    let sound: Vec<Fit> =
        fits.iter().filter(|fit| fit.modes.iter().all(ModeEstimate::is_damped)).cloned().collect();
    if sound.is_empty() { fits } else { sound }
}

/// [`Fit::response_std`] of the first of [`advise`]d fits, including the differences between the fits, weighted by their description
/// lengths (J. A. Hoeting et al., Bayesian model averaging, Statistical Science 14, 1999).
#[must_use]
pub fn response_std_among(fits: &[Fit], frequency_hz: f64) -> [f64; 2] {
    let Some(first) = fits.first() else { return [f64::INFINITY; 2] };
    let response = first.transfer.response(frequency_hz);
    let (mut total, mut squares) = (0.0, [0.0; 2]);
    for fit in fits {
        let longer = fit.description_length - first.description_length;
        if longer > MOST_DIFFERENCE {
            continue;
        }
        let weight = (-0.5 * longer).exp();
        let off = (fit.transfer.response(frequency_hz) / response).ln();
        let std = fit.response_std(frequency_hz);
        total += weight;
        squares[0] += weight * (std[0].powi(2) + off.re.powi(2));
        squares[1] += weight * (std[1].powi(2) + off.im.powi(2));
    }
    squares.map(|sum| (sum / total).sqrt())
}

#[cfg(test)]
mod tests;
