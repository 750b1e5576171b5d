//! Outputs that were computed from another one before they were recorded: an encoder's speed that is the difference of its angles. It holds
//! nothing that the angle does not hold, and the errors of the two are one; as two sensors they would count twice.

use nalgebra::{DMatrix, DVector};
use socam_model::{Channel, Quantity};
use socam_recording::Dataset;

use crate::{
    IdentifyError,
    preprocessing::{
        mask::Mask,
        segments::{self, Segment},
    },
};

/// Rows that are compared, and fewest of these.
const MOST_ROWS: u64 = 4_000;
const FEWEST_ROWS: usize = 400;
/// Largest distance of a computed value from the best linear combination of angles, in units of its own noise, and per cent of the values that
/// must lie within twice that: a few follow a read that failed.
const MOST_LEFT: f64 = 0.1;
const USUAL: usize = 95;
/// Largest ratio of the noise at every second sample over the noise at every one: of independent errors of an angle it is 1; of an angle that
/// was computed from a speed, whose errors add up, 1.4. Where the motion is as large as the noise it is larger still.
const MOST_GROWTH: f64 = 1.25;

/// The speeds of a recording that were computed from one of its angles, by their indices among the outputs. Values that `mask` leaves out
/// are not compared.
///
/// # Errors
/// When a recording cannot be read.
pub(crate) fn find(
    outputs: &[&Channel],
    dataset: &Dataset,
    segments: &[&Segment],
    mask: &Mask,
) -> Result<Vec<usize>, IdentifyError> {
    let of = |wanted: Quantity| {
        let all = outputs.iter().enumerate().filter(move |(_, output)| output.quantity == wanted);
        all.map(|(index, _)| index).collect::<Vec<_>>()
    };
    let (speeds, angles) = (of(Quantity::Speed), of(Quantity::Angle));
    let Some(longest) = segments.iter().max_by_key(|segment| segment.rows) else { return Ok(Vec::new()) };
    if speeds.is_empty() || angles.is_empty() {
        return Ok(Vec::new());
    }
    let read = |output: usize| -> Result<Vec<f64>, IdentifyError> {
        let column = dataset.channel_index(&outputs[output].column)?;
        let rows = longest.first_row..longest.first_row + longest.rows.min(MOST_ROWS);
        let mut values = segments::recorded(dataset, column, rows.clone())?;
        mask.leave_out(output, rows, &mut values);
        Ok(values)
    };
    let angles = angles.into_iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let mut found = Vec::new();
    for speed in speeds {
        let values = read(speed)?;
        if angles.iter().any(|angle| is_computed(&values, angle)) {
            found.push(speed);
        }
    }
    Ok(found)
}

/// Whether each speed is the same linear combination of five angles about it and the two speeds before it: a difference, filtered or not.
fn is_computed(speeds: &[f64], angles: &[f64]) -> bool {
    let growth = noise(angles, 2) / noise(angles, 1);
    // Without independent errors of the angle the two are not told from two sensors of one motion.
    if growth.is_nan() || growth > MOST_GROWTH {
        return false;
    }
    let rows: Vec<[f64; 7]> = (2..speeds.len().saturating_sub(2))
        .map(|k| {
            let step = |other: usize| angles[other] - angles[k];
            [step(k - 2), step(k - 1), step(k + 1), step(k + 2), speeds[k - 1], speeds[k - 2], speeds[k]]
        })
        .filter(|row| row.iter().all(|value| value.is_finite()))
        .collect();
    if rows.len() < FEWEST_ROWS {
        return false;
    }
    let largest = |column: usize| rows.iter().fold(0.0_f64, |most, row| most.max(row[column].abs()));
    let scales: Vec<f64> = (0..6).map(|column| largest(column).max(f64::MIN_POSITIVE)).collect();
    let matrix = DMatrix::from_fn(rows.len(), 6, |row, column| rows[row][column] / scales[column]);
    let right = DVector::from_fn(rows.len(), |row, _| rows[row][6]);
    // Angles and earlier speeds may be redundant themselves.
    let qr = matrix.clone().qr();
    let Ok(solution) = qr.r().svd(true, true).solve(&qr.q().tr_mul(&right), 1e-12) else { return false };
    let mut rest: Vec<f64> = (right - matrix * solution).iter().map(|rest| rest.abs()).collect();
    let most = USUAL * rest.len() / 100;
    let (_, usual, _) = rest.select_nth_unstable_by(most, f64::total_cmp);
    *usual < 2.0 * MOST_LEFT * noise(speeds, 1)
}

/// Standard deviation of a channel's independent errors: the distance of its values from the cubic through two values on either side, `every`
/// rows apart.
fn noise(values: &[f64], every: usize) -> f64 {
    let pair = |k: usize, distance: usize| values[k - distance * every] + values[k + distance * every];
    let off = (2 * every..values.len().saturating_sub(2 * every))
        .map(|k| values[k] - (4.0 * pair(k, 1) - pair(k, 2)) / 6.0)
        .filter(|off| off.is_finite());
    let (sum, count) = off.fold((0.0, 0_u32), |(sum, count), off| (sum + off * off, count + 1));
    // The variance of the distance is 1 + 2 (16 + 1) / 36 times that of a value.
    (sum / f64::from(count) / (1.0 + 34.0 / 36.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 1e-3;

    fn angle(k: u32) -> f64 {
        let t = STEP_S * f64::from(k);
        3.0 * (7.0 * t).sin() + 0.2 * (60.0 * t).sin()
    }

    fn speed(k: u32) -> f64 {
        let t = STEP_S * f64::from(k);
        21.0 * (7.0 * t).cos() + 12.0 * (60.0 * t).cos()
    }

    /// Between -0.5 and 0.5, without order.
    fn noise_at(k: u32) -> f64 {
        let mixed = (k ^ (k >> 16)).wrapping_mul(0x7feb_352d);
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x846c_a68b);
        f64::from(mixed ^ (mixed >> 16)) / f64::from(u32::MAX) - 0.5
    }

    fn differences(angles: &[f64]) -> Vec<f64> {
        let each = angles.windows(2).map(|pair| (pair[1] - pair[0]) / STEP_S);
        std::iter::once(0.0).chain(each).collect()
    }

    #[test]
    fn a_speed_is_computed_where_its_errors_are_those_of_the_angle() {
        let step = std::f64::consts::TAU / 8192.0;
        let counted: Vec<f64> = (0..5000).map(|k| (angle(k) / step).floor() * step).collect();
        let noisy: Vec<f64> = (0..5000).map(|k| angle(k) + 1e-4 * noise_at(k)).collect();
        for angles in [&counted, &noisy] {
            let differences = differences(angles);
            assert!(is_computed(&differences, angles));
            let mut last = 0.0;
            let filtered = differences.iter().map(|own| {
                last += 0.2 * (own - last);
                last
            });
            assert!(is_computed(&filtered.collect::<Vec<_>>(), angles));
        }
    }

    #[test]
    fn two_sensors_of_one_motion_are_not_computed() {
        let clean: Vec<f64> = (0..5000).map(angle).collect();
        let noisy: Vec<f64> = (0..5000).map(|k| angle(k) + 1e-4 * noise_at(k)).collect();
        let speeds: Vec<f64> = (0..5000).map(speed).collect();
        let measured: Vec<f64> = (0..5000).map(|k| speed(k) + 0.05 * noise_at(k + 9000)).collect();
        for (angles, speeds) in
            [(&clean, &speeds), (&noisy, &speeds), (&noisy, &measured), (&clean, &measured)]
        {
            assert!(!is_computed(speeds, angles));
        }
        assert!(!is_computed(&differences(&clean), &clean));
        // An angle that a drive computed from its speed: the speed is the sensor.
        let mut sum = 0.0;
        let integrated = measured.iter().map(|own| {
            sum += STEP_S * own;
            sum
        });
        assert!(!is_computed(&measured, &integrated.collect::<Vec<_>>()));
    }
}
