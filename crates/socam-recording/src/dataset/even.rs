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
/// Rows that are compared, and fewest of these.
const MOST_ROWS: usize = 20_000;
const FEWEST_ROWS: usize = 200;
/// Ratio of the distances from a smooth curve, on the stamps over on even times, from which even times are right; of no channel may it be as
/// far on the other side as `OPPOSED`.
const RIGHT: f64 = 1.2;
const OPPOSED: f64 = 0.95;

impl Dataset {
    /// The recording on even times where its stamps are uneven and its samples say that they were taken evenly; otherwise unchanged.
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
        if !self.is_smoother_on(&stamps, &even)? {
            return Ok(self);
        }
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
            "its time stamps are off by up to {:.3} ms, but its samples were taken evenly, every {:.3} ms: they follow smoother curves so, and even times were used",
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

    /// Whether the channels follow smooth curves over these times rather than over their stamps.
    fn is_smoother_on(&self, stamps: &[f64], even: &[f64]) -> Result<bool> {
        let rows = stamps.len().min(MOST_ROWS);
        let columns = self.load_rows(0..rows as u64)?.columns;
        let ratio =
            |values: &[f64]| Some(roughness(&stamps[..rows], values)? / roughness(&even[..rows], values)?);
        let ratios = columns.iter().filter_map(|own| ratio(own.values()));
        let ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
        Ok(ratios.iter().any(|ratio| *ratio > RIGHT) && ratios.iter().all(|ratio| *ratio > OPPOSED))
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

/// Median distance of values from the cubic through two neighbours on either side, in units of what noise alone makes of it; `None` for too
/// few values, or where most lie on that curve.
fn roughness(times: &[f64], values: &[f64]) -> Option<f64> {
    let mut distances: Vec<f64> = (2..values.len().saturating_sub(2))
        .filter_map(|row| {
            let beside = [row - 2, row - 1, row + 1, row + 2];
            let weight = |own: usize| -> f64 {
                let others = beside.iter().filter(|other| **other != own);
                others.map(|other| (times[row] - times[*other]) / (times[own] - times[*other])).product()
            };
            let weights = beside.map(weight);
            let curve: f64 = beside.iter().zip(weights).map(|(own, weight)| weight * values[*own]).sum();
            let noise = (1.0 + weights.iter().map(|weight| weight * weight).sum::<f64>()).sqrt();
            Some((values[row] - curve).abs() / noise).filter(|distance| distance.is_finite())
        })
        .collect();
    if distances.len() < FEWEST_ROWS {
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
        assert!(even.warnings().iter().any(|warning| warning.to_string().contains("taken evenly")));
        let uneven = run(false).on_even_times().unwrap();
        assert!(uneven.steps().unwrap().are_irregular());
        assert!(uneven.warnings().is_empty());
    }

    #[test]
    fn a_lost_sample_is_not_evened_out() {
        let stamps: Vec<f64> = (0..400).map(|k| 1e-3 * f64::from(k + i32::from(k > 200))).collect();
        assert_eq!(even_times(&stamps, 0.01), None);
    }
}
