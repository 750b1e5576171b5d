//! Derivative and integral of samples in uneven steps, by the polynomials through neighbouring samples.

use std::ops::Range;

/// Samples on either side of a sample that its derivative uses.
const BESIDE: usize = 4;

/// Derivative at each sample, per second: of the polynomial through it and up to [`BESIDE`] samples on either side, as many on both, and
/// of a parabola at the ends.
pub(super) fn rate(values: &[f64], time_s: &[f64]) -> Vec<f64> {
    let rows = values.len();
    let near = |row: usize| -> Range<usize> {
        match row.min(rows - 1 - row).min(BESIDE) {
            0 if row == 0 => 0..rows.min(3),
            0 => rows.saturating_sub(3)..rows,
            reach => row - reach..row + reach + 1,
        }
    };
    (0..rows).map(|row| near(row).map(|at| slope(time_s, near(row), at, row) * values[at]).sum()).collect()
}

/// Derivative at sample `row` of the Lagrange polynomial of sample `at` among the samples `near`, 1/s.
fn slope(time_s: &[f64], near: Range<usize>, at: usize, row: usize) -> f64 {
    let others = || near.clone().filter(|other| *other != at);
    if at == row {
        return others().map(|other| 1.0 / (time_s[row] - time_s[other])).sum();
    }
    let above: f64 =
        others().filter(|other| *other != row).map(|other| time_s[row] - time_s[other]).product();
    above / others().map(|other| time_s[at] - time_s[other]).product::<f64>()
}

/// Integral at each sample, `start` at the first: over each step that of the cubic through the two samples on either side of it, of a line
/// at the ends.
pub(super) fn integral(values: &[f64], time_s: &[f64], start: f64) -> Vec<f64> {
    let middle = |k: usize| {
        let near = k.checked_sub(2)?..(k + 1 < values.len()).then_some(k + 2)?;
        let now_s = 0.5 * (time_s[k - 1] + time_s[k]);
        let weight = |at: usize| {
            let others = near.clone().filter(move |other| *other != at);
            others.map(|other| (now_s - time_s[other]) / (time_s[at] - time_s[other])).product::<f64>()
        };
        Some(near.clone().map(|at| weight(at) * values[at]).sum::<f64>())
    };
    let mean = |k: usize| {
        let line = 0.5 * (values[k - 1] + values[k]);
        (2.0 * middle(k).unwrap_or(line) + line) / 3.0
    };
    let sums = (0..values.len()).scan(start, |sum, k| {
        *sum += if k == 0 { 0.0 } else { (time_s[k] - time_s[k - 1]) * mean(k) };
        Some(*sum)
    });
    sums.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tone_is_differentiated_and_integrated_at_uneven_times() {
        let time_s: Vec<f64> =
            (0..200).map(|k| 0.01 * (f64::from(k) + 0.3 * f64::from(k * k % 7) / 7.0)).collect();
        let tone: Vec<f64> = time_s.iter().map(|t| (20.0 * t).sin()).collect();
        let (found, sums) = (rate(&tone, &time_s), integral(&tone, &time_s, 3.0));
        for (k, t) in time_s.iter().enumerate() {
            let tolerance = if (4..196).contains(&k) { 1e-4 } else { 0.4 };
            assert!((found[k] - 20.0 * (20.0 * t).cos()).abs() < tolerance, "{k}: {}", found[k]);
            let expected = 3.0 + ((20.0 * time_s[0]).cos() - (20.0 * t).cos()) / 20.0;
            assert!(
                (sums[k] - expected).abs() < if k < 198 { 1e-5 } else { 1e-4 },
                "{k}: {} {expected}",
                sums[k]
            );
        }
        assert_eq!((rate(&[], &[]), rate(&[2.0], &[0.1])), (vec![], vec![0.0]));
        assert_eq!(rate(&[2.0, 5.0], &[0.0, 0.5]), [6.0, 6.0]);
        assert_eq!(integral(&[2.0, 4.0], &[0.0, 0.5], 1.0), [1.0, 2.5]);
    }
}
