//! Samples of one clock at the times of another.

/// Longest step that is bridged, in usual steps.
const BRIDGED: f64 = 2.5;
/// Ratio of a clock's step to that of the rows from which its channels have no value between their samples.
const SLOW: f64 = 3.0;

/// Interpolation of a channel between the samples of another clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Between {
    /// Linear.
    Linear,
    /// The last value.
    Hold,
    /// Missing: each sample is put at the nearest row.
    Missing,
}

/// Median of the steps between increasing times, s; none of fewer than two.
#[must_use]
pub fn median_step_s(times_s: &[f64]) -> Option<f64> {
    let mut steps_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps_s.len() / 2;
    (!steps_s.is_empty()).then(|| *steps_s.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The values that are there, with their times.
#[must_use]
pub fn present(times_s: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    times_s.iter().zip(values).filter(|(_, value)| value.is_finite()).unzip()
}

/// Interpolation of a channel for which none is stated: linear, unless its steps are much longer than those of the rows.
#[must_use]
pub fn usual(rows_s: &[f64], times_s: &[f64]) -> Between {
    match (median_step_s(rows_s), median_step_s(times_s)) {
        (Some(row), Some(step)) if step >= SLOW * row => Between::Missing,
        _ => Between::Linear,
    }
}

/// Values at the times `rows_s` from samples at `times_s`, both increasing; NaN outside, and in pauses of more than 2.5 usual steps.
#[must_use]
pub fn at_rows(rows_s: &[f64], times_s: &[f64], values: &[f64], between: Between) -> Vec<f64> {
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

/// Puts each sample at the nearest row; outside the rows and in pauses of theirs, only within half a usual step.
fn nearest(rows_s: &[f64], times_s: &[f64], values: &[f64]) -> Vec<f64> {
    let mut placed = vec![f64::NAN; rows_s.len()];
    let row_step_s = median_step_s(rows_s).unwrap_or(0.0);
    let reach_s = 0.5 * row_step_s * (1.0 + 1e-9);
    for (time_s, value) in times_s.iter().zip(values) {
        let next = rows_s.partition_point(|row| row < time_s);
        let distance = |row: usize| rows_s.get(row).map_or(f64::INFINITY, |row_s| (row_s - time_s).abs());
        let (row, other) = match next.checked_sub(1) {
            Some(before) if distance(before) <= distance(next) => (before, next),
            Some(before) => (next, before),
            None => (next, usize::MAX),
        };
        let is_between = distance(row) + distance(other) <= BRIDGED * row_step_s;
        if distance(row) <= reach_s || is_between {
            placed[row] = *value;
        }
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The values with -1 for NaN, which does not equal itself.
    fn shown(values: &[f64]) -> Vec<f64> {
        values.iter().map(|value| if value.is_nan() { -1.0 } else { *value }).collect()
    }

    #[test]
    fn channels_of_another_clock_are_placed_as_said() {
        let rows = [0.0, 1.0, 2.0, 3.0, 4.0];
        let (times, values) = ([0.5, 1.5, 2.5], [10.0, 20.0, 30.0]);
        let show = |between| shown(&at_rows(&rows, &times, &values, between));
        assert_eq!(show(Between::Linear), [-1.0, 15.0, 25.0, -1.0, -1.0]);
        assert_eq!(show(Between::Hold), [-1.0, 10.0, 20.0, 30.0, -1.0]);
        // A hole of the other clock is not bridged.
        let gap = at_rows(&rows, &[0.0, 0.5, 1.0, 4.0], &[0.0, 1.0, 2.0, 3.0], Between::Linear);
        assert_eq!(shown(&gap), [0.0, 2.0, -1.0, -1.0, 3.0]);
        assert_eq!(usual(&rows, &[0.0, 10.0]), Between::Missing);
        assert_eq!(usual(&rows, &times), Between::Linear);
    }

    #[test]
    fn no_slow_sample_is_lost_between_uneven_rows_and_none_is_put_into_a_pause_of_the_rows() {
        let put = |rows: &[f64], time_s: f64| shown(&at_rows(rows, &[time_s], &[7.0], Between::Missing));
        let rows = [0.0, 1.0, 2.4, 3.4, 9.0];
        assert_eq!(put(&rows, 1.2), [-1.0, 7.0, -1.0, -1.0, -1.0]);
        assert_eq!(put(&rows, 1.75), [-1.0, -1.0, 7.0, -1.0, -1.0]);
        assert_eq!(put(&rows, 5.0), [-1.0; 5]);
        assert_eq!(put(&rows, 9.4), [-1.0, -1.0, -1.0, -1.0, 7.0]);
        assert_eq!(put(&rows, 9.9), [-1.0; 5]);
        assert_eq!(put(&rows, -0.9), [-1.0; 5]);
    }
}
