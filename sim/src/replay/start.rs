//! The states that a recording begins in: nobody measured them all, but the first outputs tell.

use nalgebra::{DMatrix, DVector};
use socam_model::Motion;

use super::{Feed, Replay};
use crate::SimError;
use crate::plant::Plant;

/// Samples that are looked at: enough to tell a speed from a noisy position, few enough that the model's own errors do not
/// count yet.
const WINDOW: usize = 50;

/// Gauss-Newton steps; the problem is nearly linear.
const STEPS: usize = 3;

/// Directions in which the outputs hardly answer, beside how they answer to the states that make them up, stay at rest.
const RANK_TOLERANCE: f64 = 1e-4;

/// Sizes that states usually have, for differences and for "smallest": rad and rad/s, m and m/s.
const ROTATION_SIZES: (f64, f64) = (0.1, 10.0);
const TRANSLATION_SIZES: (f64, f64) = (0.1, 0.1);

/// The smallest states at the first of `rows` from which the model best meets the first measured outputs.
pub(super) fn fit(
    replay: &Replay,
    plant: &Plant,
    feed: &Feed,
    rows: std::ops::Range<usize>,
) -> Result<Vec<f64>, SimError> {
    let weights = weights(feed);
    let misses = |states: &[f64]| misses(replay, plant, feed, rows.clone(), &weights, states);
    let sizes = sizes(replay, plant);
    let mut states = vec![0.0; plant.states()];
    for _ in 0..STEPS {
        let miss = misses(&states)?;
        if miss.is_empty() {
            break;
        }
        let mut slopes = DMatrix::zeros(miss.len(), states.len());
        for (index, size) in sizes.iter().enumerate() {
            let mut moved = states.clone();
            moved[index] += 1e-3 * size;
            slopes.set_column(index, &((misses(&moved)? - &miss) / 1e-3));
        }
        // A hundredth of a radian in a stiff spring is felt a thousand times as much as a rad/s: each state by what it does.
        let lengths: Vec<f64> = slopes.column_iter().map(|column| column.norm()).collect();
        let unit = |length: f64| if length > 0.0 { 1.0 / length } else { 0.0 };
        slopes.column_iter_mut().zip(&lengths).for_each(|(mut column, length)| column *= unit(*length));
        let svd = slopes.svd(true, true);
        let least = RANK_TOLERANCE * svd.singular_values.max();
        let Ok(change) = svd.solve(&-miss, least) else { break };
        for (index, state) in states.iter_mut().enumerate() {
            *state += change[index] * unit(lengths[index]) * sizes[index];
        }
    }
    Ok(states)
}

/// One over the range of each measured output, so that all of them count alike.
fn weights(feed: &Feed) -> Vec<f64> {
    let weight = |measured: &Option<Vec<f64>>| {
        let values = measured.as_deref().unwrap_or_default();
        let largest =
            values.iter().filter(|value| !value.is_nan()).fold(0.0, |largest: f64, v| largest.max(v.abs()));
        if largest > 0.0 { 1.0 / largest } else { 0.0 }
    };
    feed.measured.iter().map(weight).collect()
}

fn misses(
    replay: &Replay,
    plant: &Plant,
    feed: &Feed,
    rows: std::ops::Range<usize>,
    weights: &[f64],
    states: &[f64],
) -> Result<DVector<f64>, SimError> {
    let mut misses = Vec::new();
    let mut row = rows.start;
    let mut trajectory = plant.start_at(states)?;
    replay.follow(&mut trajectory, feed, rows, WINDOW, |outputs| {
        for ((output, measured), weight) in outputs.iter().zip(&feed.measured).zip(weights) {
            let measured = measured.as_ref().map(|values| values[row]).filter(|value| !value.is_nan());
            misses.extend(measured.map(|measured| weight * (output - measured)));
        }
        row += 1;
    })?;
    Ok(DVector::from_vec(misses))
}

fn sizes(replay: &Replay, plant: &Plant) -> Vec<f64> {
    let (angle, speed) = match replay.truth.model.motion {
        Motion::Rotation => ROTATION_SIZES,
        Motion::Translation => TRANSLATION_SIZES,
    };
    plant.speeds().iter().map(|is_speed| if *is_speed { speed } else { angle }).collect()
}
