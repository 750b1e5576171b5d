//! The knots of the straight lines in which a recorded input moves.
//!
//! A band-limited input goes through points between its samples that a windowed sinc gives (Kaiser's window), [`PARTS`] a sample.
//! Straight lines between such points lose a twelfth of the signal's second difference on that finer grid; the knots are
//! moved by as much.

use std::{ops::Range, sync::LazyLock};

use socam_model::Intersample;

/// Parts of a sample.
pub(super) const PARTS: usize = 4;

/// Samples to either side that a knot depends on.
const REACH: usize = 17;

/// Half the width of the window, samples, and its shape.
const HALF_WIDTH: f64 = 16.0;
const SHAPE: f64 = 9.0;

/// Knots of one input over the sample that ends at `row`, one for each part of it, the sample's own at last. `rows` are those
/// without a gap about it; beyond them the input is taken to go on point-symmetrically, for as many
/// rows as there are.
pub(super) fn knots(
    values: &[f64],
    rows: &Range<usize>,
    row: usize,
    intersample: Intersample,
) -> [f64; PARTS] {
    let last = row.saturating_sub(1).max(rows.start);
    let (from, to) = (values[last], values[row]);
    match intersample {
        Intersample::Hold => [from; PARTS],
        Intersample::Linear => {
            std::array::from_fn(|part| from + (to - from) * (part + 1) as f64 / PARTS as f64)
        }
        Intersample::BandLimited => std::array::from_fn(|part| knot(values, rows, last, part + 1)),
    }
}

/// Where a band-limited input's line begins at a sample.
pub(super) fn first(values: &[f64], rows: &Range<usize>, row: usize, intersample: Intersample) -> f64 {
    match intersample {
        Intersample::Hold | Intersample::Linear => values[row],
        Intersample::BandLimited => knot(values, rows, row, 0),
    }
}

/// `part` parts after a sample. What a straight line through that sample and the next leaves is interpolated: lines are met exactly.
fn knot(values: &[f64], rows: &Range<usize>, row: usize, part: usize) -> f64 {
    let (first, last) = (rows.start as i64, rows.end as i64 - 1);
    let at = |k: i64| {
        let inside = k.clamp(first, last);
        let mirrored = (2 * inside - k).clamp(first, last);
        2.0 * values[inside as usize] - values[mirrored as usize]
    };
    let at = |k: i64| if (first..=last).contains(&k) { values[k as usize] } else { at(k) };
    let row = row as i64;
    let (start, slope) = (at(row), at(row + 1) - at(row));
    let line = |m: i64| start + slope * m as f64;
    let reach = REACH as i64;
    let weights = KNOTS[part].iter().zip(-reach..);
    let rest: f64 = weights.map(|(weight, m)| weight * (at(row + m) - line(m))).sum();
    start + slope * part as f64 / PARTS as f64 + rest
}

/// By part, weights of the samples from [`REACH`] before to as many after and one.
static KNOTS: LazyLock<[Vec<f64>; PARTS + 1]> = LazyLock::new(|| {
    std::array::from_fn(|part| {
        let at = |part: f64| {
            let position = part / PARTS as f64;
            let weights = (-(REACH as i64)..=REACH as i64 + 1).map(|m| windowed_sinc(position - m as f64));
            let weights: Vec<f64> = weights.collect();
            let sum: f64 = weights.iter().sum();
            weights.into_iter().map(|weight| weight / sum).collect::<Vec<f64>>()
        };
        let part = part as f64;
        let near = [at(part - 1.0), at(part), at(part + 1.0)];
        let sharpened = |m: usize| near[1][m] - (near[0][m] - 2.0 * near[1][m] + near[2][m]) / 12.0;
        (0..near[1].len()).map(sharpened).collect()
    })
});

fn windowed_sinc(x: f64) -> f64 {
    if x.abs() >= HALF_WIDTH {
        return 0.0;
    }
    let angle = std::f64::consts::PI * x;
    let sinc = if angle == 0.0 { 1.0 } else { angle.sin() / angle };
    let share = x / HALF_WIDTH;
    sinc * bessel(SHAPE * (1.0 - share * share).sqrt()) / bessel(SHAPE)
}

/// Modified Bessel function of the first kind and order zero, by its series.
fn bessel(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for n in 1..60 {
        term *= (x / (2 * n) as f64).powi(2);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_of_a_tone_lie_off_it_by_a_twelfth_of_its_second_difference() {
        for x in [0.2_f64, 0.9, 1.3] {
            let tone = |t: f64| (x * t + 0.4).sin();
            let values: Vec<f64> = (0..80).map(|k| tone(f64::from(k))).collect();
            let fine = x / PARTS as f64;
            let exact = |t: f64| tone(t) * (1.0 + (2.0 - 2.0 * fine.cos()) / 12.0);
            for (part, knot) in knots(&values, &(0..80), 40, Intersample::BandLimited).iter().enumerate() {
                let t = 39.0 + (part + 1) as f64 / PARTS as f64;
                assert!((knot - exact(t)).abs() < 2e-4, "{x} {part}: {knot} {}", exact(t));
            }
        }
    }

    #[test]
    fn lines_are_met_to_their_ends_and_held_inputs_stay() {
        let values: Vec<f64> = (0..40).map(|k| 3.0 * f64::from(k) - 7.0).collect();
        for row in 1..40 {
            let expected: [f64; PARTS] =
                std::array::from_fn(|part| values[row - 1] + 3.0 * (part + 1) as f64 / PARTS as f64);
            for kind in [Intersample::Linear, Intersample::BandLimited] {
                let knots = knots(&values, &(0..40), row, kind);
                assert!(knots.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{knots:?}");
            }
            assert_eq!(knots(&values, &(0..40), row, Intersample::Hold), [values[row - 1]; PARTS]);
        }
    }
}
