//! Intersample reconstruction: the knots of the piecewise-linear input that drives the solver.
//!
//! A band-limited input is interpolated by a windowed sinc (Kaiser window) at [`PARTS`] points per sample. Linear interpolation
//! between them loses a twelfth of the signal's second difference on the finer grid; the knots are prefiltered by this amount.

use std::{ops::Range, sync::LazyLock};

use socam_model::Intersample;

/// Points per sample.
pub(super) const PARTS: usize = 4;

/// Samples on either side that a knot depends on.
const REACH: usize = 17;

/// Half width of the window, samples, and its shape parameter.
const HALF_WIDTH: f64 = 16.0;
const SHAPE: f64 = 9.0;

/// Knots of one input over the sampling interval that ends at `row`, the last one at `row`. `rows` is the segment without a gap; the
/// input is extended point-symmetrically beyond it, by at most its own length.
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

/// The knot at a sample from which the next interval starts.
pub(super) fn first(values: &[f64], rows: &Range<usize>, row: usize, intersample: Intersample) -> f64 {
    match intersample {
        Intersample::Hold | Intersample::Linear => values[row],
        Intersample::BandLimited => knot(values, rows, row, 0),
    }
}

/// The knot `part` points after a sample. The deviation from the line through that sample and the next is interpolated, so straight
/// lines are exact.
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

/// For each point, weights of the samples from [`REACH`] before to [`REACH`] + 1 after.
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
