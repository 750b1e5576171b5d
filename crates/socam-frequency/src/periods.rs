//! Period of a signal, and its steady periods.

use std::ops::Range;

use socam_spectrum::autocorrelation;

/// Least correlation of a periodic signal with itself one period later.
const LEAST_CORRELATION: f64 = 0.9;
/// The correlation must fall below this at a shorter lag than the period: slow signals correlate at every short lag.
const LOW_CORRELATION: f64 = 0.5;
/// Tolerance of the best correlation; the shortest candidate within it is the period, others are its multiples.
const TOLERANCE: f64 = 0.03;
const SHORTEST: usize = 8;
/// A period at either end that differs from the median period by this many typical differences belongs to a start or an end.
const UNUSUAL: f64 = 3.0;

/// Length of a signal's period in samples; `None` if it does not repeat within half of its length.
///
/// If a ramp or a fading offset hides the repetition, it is sought in the differences of the signal.
#[must_use]
pub fn period(values: &[f64]) -> Option<usize> {
    let steps = || values.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<f64>>();
    // Differences of few sines can correlate at a lag that is not their period, so the signal itself is checked too.
    let hidden = || alike_again(&steps()).into_iter().find(|lag| repeats(values, *lag));
    alike_again(values).first().copied().or_else(hidden)
}

/// Whether the signal itself, not only its differences, repeats after one period; a staircase does not.
fn repeats(values: &[f64], period: usize) -> bool {
    let rows = steady(values, period);
    let whole = &values[rows];
    if whole.len() < 2 * period {
        return false;
    }
    let changes: Vec<f64> = whole.iter().zip(&whole[period..]).map(|(a, b)| (b - a).abs()).collect();
    let middle = median(&whole[..period]);
    let swings: Vec<f64> = whole[..period].iter().map(|value| (value - middle).abs()).collect();
    median(&changes) < LOW_CORRELATION * median(&swings)
}

/// Lags with nearly the greatest autocorrelation, the shortest first.
fn alike_again(values: &[f64]) -> Vec<usize> {
    let length = values.len();
    if length < 4 * SHORTEST {
        return Vec::new();
    }
    let correlation = autocorrelation(values);
    let mean = values.iter().sum::<f64>() / length as f64;
    // Energy of the first n samples, to normalise the correlation of overlapping parts.
    let mut energy = vec![0.0; length + 1];
    for (n, value) in values.iter().enumerate() {
        energy[n + 1] = energy[n] + (value - mean).powi(2);
    }
    let normal = |lag: usize| {
        let overlap = (energy[length - lag] * (energy[length] - energy[lag])).sqrt();
        if overlap > 1e-12 * energy[length] { correlation[lag] / overlap } else { 0.0 }
    };
    let alike: Vec<f64> = (0..=length / 2).map(normal).collect();
    let Some(unlike) = alike.iter().position(|c| *c < LOW_CORRELATION) else { return Vec::new() };
    let mut peaks: Vec<usize> = (unlike.max(SHORTEST)..alike.len() - 1)
        .filter(|lag| {
            alike[*lag] > LEAST_CORRELATION && alike[*lag] >= alike[lag - 1] && alike[*lag] > alike[lag + 1]
        })
        .collect();
    let best = peaks.iter().map(|lag| alike[*lag]).fold(0.0, f64::max);
    peaks.retain(|lag| alike[*lag] >= best - TOLERANCE);
    peaks
}

/// Rows of the longest sequence of equal whole periods: fading at either end is left out, and so is the first of four or more periods,
/// in which the bench reaches its steady state.
#[must_use]
pub fn steady(values: &[f64], period: usize) -> Range<usize> {
    let count = values.len() / period.max(1);
    if count < 2 {
        return 0..count * period;
    }
    let median: Vec<f64> = (0..period)
        .map(|k| median(&(0..count).map(|m| values[m * period + k]).collect::<Vec<_>>()))
        .collect();
    let differences: Vec<f64> = values
        .chunks_exact(period)
        .map(|own| own.iter().zip(&median).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
        .collect();
    let size = median.iter().map(|value| value * value).sum::<f64>().sqrt();
    let limit = UNUSUAL * self::median(&differences) + 1e-9 * size;
    let usual = |m: &usize| differences[*m] <= limit;
    let mut first = (0..count).find(usual).unwrap_or(0);
    let last = (0..count).rev().find(usual).unwrap_or(count - 1);
    if first == 0 && last >= 3 {
        first = 1;
    }
    first * period..(last + 1) * period
}

pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    if sorted.is_empty() { 0.0 } else { *sorted.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn multisine(count: usize, period: usize) -> Vec<f64> {
        let line = |k: usize, t: usize| {
            (std::f64::consts::TAU * (k * t) as f64 / period as f64 + (k * k) as f64).sin()
        };
        (0..count).map(|t| [1, 3, 5, 11, 17].iter().map(|k| line(*k, t)).sum()).collect()
    }

    #[test]
    fn a_period_is_found_and_none_where_there_is_none() {
        assert_eq!(period(&multisine(2300, 400)), Some(400));
        let ramp: Vec<f64> = (0..1000).map(f64::from).collect();
        assert_eq!(period(&ramp), None);
        let steps: Vec<f64> = (0..1000).map(|t| f64::from(t / 150)).collect();
        assert_eq!(period(&steps), None);
        assert_eq!(period(&[1.0; 500]), None);
        // An offset that fades in and out.
        let faded = |(t, value): (usize, f64)| {
            let share = (t as f64 / 200.0).min(1.0).min((2300 - t) as f64 / 200.0);
            share * (20.0 + value)
        };
        let faded: Vec<f64> = multisine(2300, 400).into_iter().enumerate().map(faded).collect();
        assert_eq!(period(&faded), Some(400));
    }

    #[test]
    fn fading_periods_are_left_out() {
        let mut values = multisine(2400, 400);
        (0..100).for_each(|t| values[t] *= t as f64 / 100.0);
        (2300..2400).for_each(|t| values[t] = 0.0);
        assert_eq!(steady(&values, 400), 400..2000);
    }
}
