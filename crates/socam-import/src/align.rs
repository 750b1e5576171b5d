//! Samples of one clock at the times of another.

use crate::mapping::Between;
use crate::times::median_step_s;

/// Longest step that is interpolated over, in usual steps of the signal.
const BRIDGED: f64 = 2.5;
/// Ratio of a clock's step to that of the rows from which its channels have no value between their samples.
const SLOW: f64 = 3.0;

/// Interpolation of a channel for which the mapping states none: linear, unless its steps are much longer than those of the rows.
pub(crate) fn usual(rows_s: &[f64], times_s: &[f64]) -> Between {
    match (median_step_s(rows_s), median_step_s(times_s)) {
        (Some(row), Some(step)) if step >= SLOW * row => Between::Missing,
        _ => Between::Linear,
    }
}

/// Values at the times `rows_s`, interpolated from samples at `times_s`; NaN where there is none.
pub(crate) fn align(rows_s: &[f64], times_s: &[f64], values: &[f64], between: Between) -> Vec<f64> {
    let step_s = median_step_s(times_s).unwrap_or(f64::INFINITY);
    if between == Between::Missing {
        return nearest(rows_s, times_s, values);
    }
    let at = |row_s: &f64| {
        let next = times_s.partition_point(|time| time <= row_s);
        let before = next.checked_sub(1)?;
        let since = row_s - times_s[before];
        let Some(next_s) = times_s.get(next) else {
            let is_held = since == 0.0 || (between == Between::Hold && since <= step_s);
            return is_held.then(|| values[before]);
        };
        let step = next_s - times_s[before];
        if since == 0.0 {
            return Some(values[before]);
        }
        if step > BRIDGED * step_s {
            return None;
        }
        Some(match between {
            Between::Linear => values[before] + (values[next] - values[before]) * since / step,
            _ => values[before],
        })
    };
    rows_s.iter().map(|row_s| at(row_s).unwrap_or(f64::NAN)).collect()
}

/// Puts each sample at the nearest row, if that is not farther than half a step of the rows.
fn nearest(rows_s: &[f64], times_s: &[f64], values: &[f64]) -> Vec<f64> {
    let mut placed = vec![f64::NAN; rows_s.len()];
    let reach_s = 0.5 * median_step_s(rows_s).unwrap_or(0.0) * (1.0 + 1e-9);
    for (time_s, value) in times_s.iter().zip(values) {
        let next = rows_s.partition_point(|row| row < time_s);
        let distance = |row: usize| rows_s.get(row).map_or(f64::INFINITY, |row_s| (row_s - time_s).abs());
        let row = match next.checked_sub(1) {
            Some(before) if distance(before) <= distance(next) => before,
            _ => next,
        };
        if distance(row) <= reach_s {
            placed[row] = *value;
        }
    }
    placed
}

/// Unwraps values that begin anew after `range`, such as counts of an encoder. Returns the number of wraps.
pub(crate) fn unwrap(values: &mut [f64], range: f64) -> usize {
    let (mut turns, mut count, mut last) = (0.0, 0, f64::NAN);
    for value in values {
        if value.is_nan() {
            continue;
        }
        let step = *value - last;
        if step.abs() > range / 2.0 {
            turns -= (step / range).round();
            count += 1;
        }
        last = *value;
        *value += turns * range;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_of_another_clock_are_placed_as_said() {
        let rows = [0.0, 1.0, 2.0, 3.0, 4.0];
        let (times, values) = ([0.5, 1.5, 2.5], [10.0, 20.0, 30.0]);
        let show = |between| align(&rows, &times, &values, between).map_nan();
        assert_eq!(show(Between::Linear), [-1.0, 15.0, 25.0, -1.0, -1.0]);
        assert_eq!(show(Between::Hold), [-1.0, 10.0, 20.0, 30.0, -1.0]);
        assert_eq!(
            align(&rows, &[1.2, 3.1], &[7.0, 8.0], Between::Missing).map_nan(),
            [-1.0, 7.0, -1.0, 8.0, -1.0]
        );
        // A hole of the other clock is not bridged.
        let gap = align(&rows, &[0.0, 0.5, 1.0, 4.0], &[0.0, 1.0, 2.0, 3.0], Between::Linear).map_nan();
        assert_eq!(gap, [0.0, 2.0, -1.0, -1.0, 3.0]);
        assert_eq!(usual(&rows, &[0.0, 10.0]), Between::Missing);
        assert_eq!(usual(&rows, &times), Between::Linear);
    }

    #[test]
    fn counts_that_begin_anew_go_on() {
        let mut counts = [65_530.0, 65_534.0, f64::NAN, 2.0, 6.0, 65_534.0];
        assert_eq!(unwrap(&mut counts, 65_536.0), 2);
        assert_eq!(counts.map_nan(), [65_530.0, 65_534.0, -1.0, 65_538.0, 65_542.0, 65_534.0]);
    }

    trait MapNan {
        /// The values with -1 for NaN, which does not equal itself.
        fn map_nan(&self) -> Vec<f64>;
    }

    impl<T: AsRef<[f64]>> MapNan for T {
        fn map_nan(&self) -> Vec<f64> {
            self.as_ref().iter().map(|value| if value.is_nan() { -1.0 } else { *value }).collect()
        }
    }
}
