//! The shift that lays one recording over another, by the correlation of a channel that both have.

use socam_compare::lags::{Peak, between, correlation, peaks};
use socam_samples::Samples;

use crate::job::Handle;

/// Cells of the first search, which tries all shifts.
const COARSE: usize = 8192;
/// Cells of the last search: finer than this, a parabola through three correlations is enough.
const FINEST: usize = 4_000_000;
/// Each search has cells so many times shorter than the one before, and tries so many to both sides.
const FINER: usize = 4;
/// Rows that are read at a time.
const BLOCK: usize = 1 << 16;
/// Least share of the shorter recording that overlaps.
const OVERLAP: f64 = 0.3;
/// Least correlation of recordings that are laid over each other.
const LEAST: f64 = 0.7;
/// Most shifts that are offered where the signal repeats itself.
const MOST_OFFERED: usize = 6;

/// How two recordings lie over each other best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// Delay that is added to the times of the second recording, s.
    pub shift_s: f64,
    /// Correlation of the channel at that shift, -1 to 1.
    pub correlation: f64,
}

/// A channel of a recording.
pub type Of<'a> = (&'a Samples, usize);

/// The shifts of the second recording that make its channel most like that of the first: one, or several where the signal repeats itself, those
/// nearest to `near_s` first. Both must overlap by 30 % of the shorter one. The resolution is that of the slower recording, with a parabola
/// between its samples.
///
/// # Errors
/// When a recording is empty, the best correlation is below 0.7, or it does not fall on both sides; one sentence.
pub fn align(first: Of<'_>, second: Of<'_>, near_s: f64, handle: &Handle) -> Result<Vec<Alignment>, String> {
    let spans = [first, second].map(|(samples, _)| samples.span_s());
    let [Some(a), Some(b)] = spans else { return Err("a recording has no sample".into()) };
    let longest = (a[1] - a[0]).max(b[1] - b[0]);
    let finest = step_s(first.0).max(step_s(second.0)).max(longest / FINEST as f64);
    if longest.is_nan() || longest <= 0.0 || finest <= 0.0 {
        return Err("a recording of one sample has no shape that could be compared".into());
    }
    let mut step = finest;
    while longest / step > COARSE as f64 {
        step *= FINER as f64;
    }
    let read =
        |(samples, channel): Of<'_>, from: f64, step: f64| cells(samples, channel, (from, step), handle);
    let (mut one, mut other) = (read(first, a[0], step)?, read(second, b[0], step)?);
    let mut peaks = search(&one.means, &other.means, handle)?;
    let coarse_s = |lag: isize| a[0] - b[0] - lag as f64 * step - near_s;
    peaks.sort_by(|a, b| coarse_s(a.lag).abs().total_cmp(&coarse_s(b.lag).abs()));
    peaks.truncate(MOST_OFFERED);
    while step > 1.5 * finest {
        step /= FINER as f64;
        (one, other) = (read(first, a[0], step)?, read(second, b[0], step)?);
        for peak in &mut peaks {
            let middle = peak.lag * FINER as isize;
            let near = middle - FINER as isize..=middle + FINER as isize;
            let found = near.filter_map(|lag| {
                Some(Peak { lag, correlation: correlation(&one.means, &other.means, lag)?.0 })
            });
            let best = found.max_by(|a, b| a.correlation.total_cmp(&b.correlation));
            *peak = best.unwrap_or(Peak { lag: middle, ..*peak });
        }
    }
    let exact = peaks.iter().map(|Peak { lag, correlation: best }| {
        let beside = [lag - 1, lag + 1].map(|lag| correlation(&one.means, &other.means, lag));
        let between = match beside {
            [Some((before, _)), Some((after, _))] => between([before, *best, after]),
            _ => 0.0,
        };
        // Cell i of the first lies over cell i + lag of the second.
        let shift_s = a[0] + one.late_s - b[0] - other.late_s - (*lag as f64 + between) * step;
        Alignment { shift_s, correlation: *best }
    });
    Ok(exact.collect())
}

/// The usual distance of samples, s.
fn step_s(samples: &Samples) -> f64 {
    let longest =
        samples.segments().iter().max_by(|a, b| (a.end_s - a.start_s).total_cmp(&(b.end_s - b.start_s)));
    longest.map_or(0.0, |segment| segment.sample_time_s)
}

/// A channel in cells of equal length.
struct Cells {
    /// Means of the values of each cell; NaN where there is none.
    means: Vec<f64>,
    /// How much later than the middles of the cells their values are on average, s.
    late_s: f64,
}

/// The cells of a channel of this length, s, the first one about `from`.
fn cells(
    samples: &Samples,
    channel: usize,
    (from, step): (f64, f64),
    handle: &Handle,
) -> Result<Cells, String> {
    let end = samples.span_s().map_or(from, |span| span[1]);
    let count = ((end - from) / step + 0.5).floor() as usize + 1;
    let (mut sums, mut counts) = (vec![0.0; count], vec![0_u32; count]);
    let (mut next, mut late_s) = (0, 0.0);
    while next < samples.rows() {
        handle.reached(0.0)?;
        let rows = next..(next + BLOCK).min(samples.rows());
        next = rows.end;
        for (time, value) in samples.times(rows.clone()).into_iter().zip(samples.values(channel, rows)) {
            let cell = ((time - from) / step + 0.5).floor() as usize;
            if value.is_finite() && cell < count {
                sums[cell] += value;
                counts[cell] += 1;
                late_s += time - from - step * cell as f64;
            }
        }
    }
    let mean = |(sum, count): (f64, u32)| if count > 0 { sum / f64::from(count) } else { f64::NAN };
    let total: f64 = counts.iter().copied().map(f64::from).sum();
    Ok(Cells { means: sums.into_iter().zip(counts).map(mean).collect(), late_s: late_s / total.max(1.0) })
}

/// The lags with the greatest correlation.
fn search(one: &[f64], other: &[f64], handle: &Handle) -> Result<Vec<Peak>, String> {
    let least = (OVERLAP * one.len().min(other.len()) as f64) as usize;
    let lags = 1 - one.len() as isize..=other.len() as isize - 1;
    let found = peaks(one, other, lags, least, |share| handle.reached(share))?;
    let best = found.as_ref().map(|found| found.peaks[0].correlation);
    match found {
        Some(found) if found.peaks[0].correlation >= LEAST => {
            if found.peaks.len() == 1 && !found.is_bounded {
                return Err(
                    "there is no clear maximum: the correlation does not fall on both sides of it".into()
                );
            }
            Ok(found.peaks)
        }
        _ => {
            let found = best.map_or_else(|| "none".into(), |best| format!("{best:.2}"));
            Err(format!("their best correlation is {found}, and {LEAST} is needed to lay one over the other"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_recording::{Channel, Dataset, Unit};

    fn of(from_s: f64, step_s: f64, rows: usize, value: impl Fn(f64) -> f64) -> Samples {
        let time_s: Vec<f64> = (0..rows).map(|row| from_s + row as f64 * step_s).collect();
        let values: Vec<f64> = time_s.iter().map(|time| value(*time)).collect();
        let channels = vec![Channel::new("x", Unit::V)];
        let data = Dataset::from_columns("r", channels, time_s.clone(), vec![values.clone()]).unwrap();
        Samples::in_memory(time_s, &[values], data.segments().to_vec())
    }

    /// A sweep: no part of it is like another one.
    fn sweep(t: f64) -> f64 {
        3.0 + (2.0 * t + 0.9 * t * t).sin()
    }

    fn all(first: &Samples, second: &Samples, near_s: f64) -> Result<Vec<Alignment>, String> {
        align((first, 0), (second, 0), near_s, &Handle::default())
    }

    fn aligned(first: &Samples, second: &Samples) -> Result<Alignment, String> {
        let [found] = all(first, second, 0.0)?[..] else { panic!() };
        Ok(found)
    }

    #[test]
    fn the_shift_is_found_to_a_part_of_a_sample() {
        let first = of(0.0, 1e-3, 8000, sweep);
        // Begins later, is slower, has another scale and offset, and a missing value.
        let second =
            of(100.0, 2e-3, 3000, |t| if t == 101.0 { f64::NAN } else { 5.0 - 0.2 * -sweep(t - 98.7654) });
        let found = aligned(&first, &second).unwrap();
        assert!((found.shift_s + 98.7654).abs() < 2e-4 && found.correlation > 0.999, "{found:?}");
        let back = aligned(&second, &first).unwrap();
        assert!((back.shift_s - 98.7654).abs() < 2e-4, "{back:?}");
    }

    #[test]
    fn a_long_recording_is_searched_in_steps() {
        let slow = |t: f64| (0.02 * t * t).sin() + 0.3 * (5.0 * t).sin();
        let (first, second) = (of(0.0, 1e-3, 60_000, slow), of(0.0, 1e-3, 50_000, |t| slow(t + 7.1234)));
        let found = aligned(&first, &second).unwrap();
        assert!((found.shift_s - 7.1234).abs() < 2e-4, "{found:?}");
    }

    #[test]
    fn what_repeats_itself_offers_the_shifts_by_its_periods_the_nearest_first() {
        let sine = |late_s: f64| of(0.0, 1e-2, 1000, move |t| (6.0 * (t - late_s)).sin());
        let found = all(&sine(0.0), &sine(0.3), 2.0).unwrap();
        let period_s = std::f64::consts::TAU / 6.0;
        let expected = [2.0, 3.0, 1.0, 4.0, 0.0, 5.0].map(|periods| periods * period_s - 0.3);
        assert_eq!(found.len(), MOST_OFFERED, "{found:?}");
        for (found, expected_s) in found.iter().zip(expected) {
            assert!((found.shift_s - expected_s).abs() < 2e-3 && found.correlation > 0.99, "{found:?}");
        }
    }

    #[test]
    fn what_differs_is_refused_with_the_reason() {
        let sine = of(0.0, 1e-2, 1000, |t| (6.0 * t).sin());
        let other = of(0.0, 1e-2, 1000, |t| (1.0 / (0.02 + t)).sin());
        assert!(aligned(&of(0.0, 1e-2, 1000, sweep), &other).unwrap_err().contains("best correlation is"));
        let constant = of(0.0, 1e-2, 1000, |_| 4.0);
        assert!(aligned(&sine, &constant).unwrap_err().contains("correlation is none"));
        let one = of(0.0, 1e-2, 1, |_| 4.0);
        assert!(aligned(&one, &one).is_err());
    }
}
