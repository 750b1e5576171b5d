//! The initial states of a recording, fitted to its first measured outputs.

use nalgebra::{DMatrix, DVector};
use socam_model::Motion;

use super::feed::Feed;
use crate::SimError;
use crate::plant::Plant;

/// Samples fitted: enough to estimate a speed from a noisy position, few enough that the model's errors stay small.
const WINDOW: usize = 50;

/// Gauss-Newton steps; the problem is nearly linear.
const STEPS: usize = 3;

/// Singular values of the scaled sensitivities below this fraction of the largest are truncated.
const RANK_TOLERANCE: f64 = 1e-4;

/// Typical sizes of states, for finite differences and for the minimum norm: rad and rad/s, m and m/s.
const ROTATION_SIZES: (f64, f64) = (0.1, 10.0);
const TRANSLATION_SIZES: (f64, f64) = (0.1, 0.1);

/// The states of least norm at the first of `rows` that fit the first measured outputs best (Gauss-Newton).
pub(super) fn fit(
    motion: Motion,
    plant: &Plant,
    feed: &Feed,
    rows: std::ops::Range<usize>,
) -> Result<Vec<f64>, SimError> {
    let weights = weights(feed);
    let residuals = |states: &[f64]| residuals(plant, feed, rows.clone(), &weights, states);
    let sizes = sizes(motion, plant);
    let mut states = vec![0.0; plant.states()];
    for _ in 0..STEPS {
        let residual = residuals(&states)?;
        if residual.is_empty() {
            break;
        }
        let mut sensitivities = DMatrix::zeros(residual.len(), states.len());
        for (index, size) in sizes.iter().enumerate() {
            let mut moved = states.clone();
            moved[index] += 1e-3 * size;
            sensitivities.set_column(index, &((residuals(&moved)? - &residual) / 1e-3));
        }
        // Columns are scaled to unit length: a small angle of a stiff spring has a far larger effect than a speed.
        let lengths: Vec<f64> = sensitivities.column_iter().map(|column| column.norm()).collect();
        let unit = |length: f64| if length > 0.0 { 1.0 / length } else { 0.0 };
        sensitivities
            .column_iter_mut()
            .zip(&lengths)
            .for_each(|(mut column, length)| column *= unit(*length));
        let svd = sensitivities.svd(true, true);
        let least = RANK_TOLERANCE * svd.singular_values.max();
        let Ok(change) = svd.solve(&-residual, least) else { break };
        for (index, state) in states.iter_mut().enumerate() {
            *state += change[index] * unit(lengths[index]) * sizes[index];
        }
    }
    Ok(states)
}

/// One over the largest magnitude of each measured output.
fn weights(feed: &Feed) -> Vec<f64> {
    let weight = |measured: &Option<Vec<f64>>| {
        let values = measured.as_deref().unwrap_or_default();
        let largest =
            values.iter().filter(|value| !value.is_nan()).fold(0.0, |largest: f64, v| largest.max(v.abs()));
        if largest > 0.0 { 1.0 / largest } else { 0.0 }
    };
    feed.measured.iter().map(weight).collect()
}

fn residuals(
    plant: &Plant,
    feed: &Feed,
    rows: std::ops::Range<usize>,
    weights: &[f64],
    states: &[f64],
) -> Result<DVector<f64>, SimError> {
    let mut residuals = Vec::new();
    let mut row = rows.start;
    let mut trajectory = plant.start_at(states)?;
    feed.follow(&mut trajectory, rows, WINDOW, |outputs| {
        for ((output, measured), weight) in outputs.iter().zip(&feed.measured).zip(weights) {
            let measured = measured.as_ref().map(|values| values[row]).filter(|value| !value.is_nan());
            residuals.extend(measured.map(|measured| weight * (output - measured)));
        }
        row += 1;
    })?;
    Ok(DVector::from_vec(residuals))
}

fn sizes(motion: Motion, plant: &Plant) -> Vec<f64> {
    let (angle, speed) = match motion {
        Motion::Rotation => ROTATION_SIZES,
        Motion::Translation => TRANSLATION_SIZES,
    };
    plant.speeds().iter().map(|is_speed| if *is_speed { speed } else { angle }).collect()
}
