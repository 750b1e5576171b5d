//! Samples that were taken evenly and stamped unevenly: by a computer that was late in reading its clock, not its converter.
//!
//! The stamps are then wrong, and a resampling by them turns their jitter into noise that is large where the motion is fast. Which of the two
//! is right shows in the samples: on the right times they lie nearer to a smooth curve.

use super::data::Dataset;
use super::grid::Resampled;
use super::regular::BRIDGED;
use crate::error::Result;

/// Largest distance of a stamp from even times, and largest distance between two stamps, in steps. Beyond these a sample was lost or the rate
/// changed.
const NEAR: f64 = 0.6;
const NEXT: f64 = 1.6;
/// Rows that are read for a comparison.
const MOST_ROWS: usize = 20_000;
/// One in this many rows is compared, those whose value differs most between the two times, and at least so many rows.
const COMPARED: usize = 10;
const FEWEST_ROWS: usize = 200;
/// Ratio of the distances from a smooth curve, on the stamps over on even times, below which a channel was sampled at its stamps.
const AT_STAMPS: f64 = 0.92;
/// The same ratio above which it was sampled evenly.
const EVENLY: f64 = 1.2;

impl Dataset {
    /// The recording on even times where its stamps are uneven and no channel says that it was sampled at them; otherwise unchanged. Where the
    /// samples cannot tell the two times apart, either predicts them alike, and even times are integrated faster.
    ///
    /// # Errors
    /// When the recording cannot be read again, or there is room for it neither in memory nor on disk.
    pub fn on_even_times(self) -> Result<Self> {
        let steps = self.steps()?;
        if !steps.are_irregular() {
            return Ok(self);
        }
        let stamps = self.stamps()?;
        let Some(even) = even_times(&stamps, BRIDGED * steps.median_s) else { return Ok(self) };
        let Some(why) = self.why_even(&stamps, &even)? else { return Ok(self) };
        let mut out = Resampled::new(self.channels().len(), self.rows());
        let mut times = even.iter();
        for block in self.blocks()? {
            let block = block?;
            for (row, time_s) in (&mut times).take(block.time_s.len()).enumerate() {
                out.push(*time_s, block.columns.iter().map(|column| column.values()[row]));
            }
        }
        let most = stamps.iter().zip(&even).map(|(stamp, even)| (stamp - even).abs()).fold(0.0, f64::max);
        let note = format!(
            "its time stamps are off by up to {:.3} ms from even times, every {:.3} ms, which were used: {why}",
            1e3 * most,
            1e3 * steps.median_s
        );
        self.resampled(out, 1, note)
    }

    /// All time stamps, s.
    pub(super) fn stamps(&self) -> Result<Vec<f64>> {
        let mut stamps = Vec::new();
        for block in self.blocks_in(0..self.rows(), &[])? {
            stamps.extend_from_slice(&block?.time_s);
        }
        Ok(stamps)
    }

    /// Why even times are right, as a part of a sentence; `None` where a channel follows a smoother curve over the stamps, or no channel says
    /// anything.
    fn why_even(&self, stamps: &[f64], even: &[f64]) -> Result<Option<&'static str>> {
        let rows = stamps.len().min(MOST_ROWS);
        let columns = self.load_rows(0..rows as u64)?.columns;
        let (stamps, even) = (&stamps[..rows], &even[..rows]);
        let ratio = |values: &[f64]| {
            let compared = most_moved(stamps, even, values)?;
            Some(roughness(stamps, values, &compared)? / roughness(even, values, &compared)?)
        };
        let ratios = columns.iter().filter_map(|own| ratio(own.values()));
        let ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
        if ratios.is_empty() || ratios.iter().any(|ratio| *ratio < AT_STAMPS) {
            return Ok(None);
        }
        let is_told = ratios.iter().any(|ratio| *ratio > EVENLY);
        Ok(Some(if is_told {
            "its samples follow smoother curves over them"
        } else {
            "its samples follow equally smooth curves over both"
        }))
    }
}

/// Even times for these stamps: a straight line by least squares for each run without a gap. `None` where a stamp is far from its own.
fn even_times(stamps: &[f64], gap_s: f64) -> Option<Vec<f64>> {
    let mut even = Vec::with_capacity(stamps.len());
    for run in stamps.chunk_by(|before, after| after - before <= gap_s) {
        if run.len() < 3 {
            even.extend_from_slice(run);
            continue;
        }
        let middle = 0.5 * (run.len() - 1) as f64;
        let mean = run.iter().sum::<f64>() / run.len() as f64;
        let (mut product, mut square) = (0.0, 0.0);
        for (row, stamp) in run.iter().enumerate() {
            let own = row as f64 - middle;
            product += own * (stamp - mean);
            square += own * own;
        }
        let step_s = product / square;
        let time_s = |row: usize| mean + step_s * (row as f64 - middle);
        if run.iter().enumerate().any(|(row, stamp)| (stamp - time_s(row)).abs() > NEAR * step_s)
            || run.windows(2).any(|pair| pair[1] - pair[0] > NEXT * step_s)
        {
            return None;
        }
        even.extend((0..run.len()).map(time_s));
    }
    even.is_sorted_by(|before, after| before < after).then_some(even)
}

/// Rows whose value differs most between the two times, by the slope there: [`COMPARED`] of all, and at least [`FEWEST_ROWS`]. `None` for too
/// few values.
fn most_moved(stamps: &[f64], even: &[f64], values: &[f64]) -> Option<Vec<usize>> {
    let moved = |row: usize| ((values[row + 1] - values[row - 1]) * (stamps[row] - even[row])).abs();
    let mut rows: Vec<(f64, usize)> = (2..values.len().saturating_sub(2))
        .map(|row| (moved(row), row))
        .filter(|(moved, _)| moved.is_finite())
        .collect();
    let count = (rows.len() / COMPARED).max(FEWEST_ROWS);
    if rows.len() < count {
        return None;
    }
    rows.select_nth_unstable_by(count - 1, |a, b| b.0.total_cmp(&a.0));
    Some(rows[..count].iter().map(|(_, row)| *row).collect())
}

/// Median distance of values at some rows from the cubic through two neighbours on either side, in units of what noise alone makes of it;
/// `None` where most lie on that curve.
fn roughness(times: &[f64], values: &[f64], rows: &[usize]) -> Option<f64> {
    let distance = |row: &usize| {
        let row = *row;
        let beside = [row - 2, row - 1, row + 1, row + 2];
        let weight = |own: usize| -> f64 {
            let others = beside.iter().filter(|other| **other != own);
            others.map(|other| (times[row] - times[*other]) / (times[own] - times[*other])).product()
        };
        let weights = beside.map(weight);
        let curve: f64 = beside.iter().zip(weights).map(|(own, weight)| weight * values[*own]).sum();
        let noise = (1.0 + weights.iter().map(|weight| weight * weight).sum::<f64>()).sqrt();
        (values[row] - curve).abs() / noise
    };
    let mut distances: Vec<f64> = rows.iter().map(distance).filter(|distance| distance.is_finite()).collect();
    if distances.is_empty() {
        return None;
    }
    let middle = distances.len() / 2;
    Some(*distances.select_nth_unstable_by(middle, f64::total_cmp).1).filter(|median| *median > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, Unit};

    /// A motion whose stamps jitter by a fifth of a step, sampled evenly or at the stamps, with gaps.
    fn run(is_even: bool) -> Dataset {
        let uneven = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1_u32 << 24) - 0.5;
        let stamp = |k: u32| 1e-3 * (f64::from(k) + 0.4 * uneven(k)) + if k > 1500 { 0.7 } else { 0.0 };
        let taken = |k: u32| {
            if is_even { 1e-3 * f64::from(k) + if k > 1500 { 0.7 } else { 0.0 } } else { stamp(k) }
        };
        let speed = |k: u32| 40.0 * (30.0 * taken(k)).sin() + 0.02 * uneven(k + 77);
        let held = |k: u32| f64::from(k / 50 % 3);
        let columns = vec![(0..3000).map(speed).collect(), (0..3000).map(held).collect()];
        let channels = vec![Channel::new("speed", Unit::RadPerS), Channel::new("torque", Unit::Nm)];
        Dataset::from_columns("run", channels, (0..3000).map(stamp).collect(), columns).unwrap()
    }

    #[test]
    fn samples_say_whether_they_were_taken_evenly() {
        let even = run(true).on_even_times().unwrap();
        assert!(!even.steps().unwrap().are_irregular());
        assert_eq!((even.rows(), even.segments().len()), (3000, 2));
        assert!(
            even.warnings().iter().any(|warning| warning.to_string().contains("smoother curves over them"))
        );
        let uneven = run(false).on_even_times().unwrap();
        assert!(uneven.steps().unwrap().are_irregular());
        assert!(uneven.warnings().is_empty());
    }

    #[test]
    fn samples_that_cannot_tell_get_even_times() {
        let noise = |k: u32| f64::from(k.wrapping_mul(2_246_822_519) >> 8) / f64::from(1_u32 << 24) - 0.5;
        let stamps = (0..3000).map(|k| 1e-3 * (f64::from(k) + 0.3 * noise(k))).collect();
        let slow = (0..3000).map(|k| 1e-3 * f64::from(k) + 0.1 * noise(k + 5000)).collect();
        let run =
            Dataset::from_columns("run", vec![Channel::new("speed", Unit::RadPerS)], stamps, vec![slow]);
        let even = run.unwrap().on_even_times().unwrap();
        assert!(!even.steps().unwrap().are_irregular());
        assert!(even.warnings().iter().any(|warning| warning.to_string().contains("equally smooth")));
    }

    #[test]
    fn a_lost_sample_is_not_evened_out() {
        let stamps: Vec<f64> = (0..400).map(|k| 1e-3 * f64::from(k + i32::from(k > 200))).collect();
        assert_eq!(even_times(&stamps, 0.01), None);
    }
}
