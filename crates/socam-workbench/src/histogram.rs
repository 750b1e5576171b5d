//! How often values of a channel occur.

use std::ops::Range;

use socam_samples::Samples;

use crate::job::Handle;

/// Rows that are read at a time.
const BLOCK: usize = 1 << 16;
/// Greatest number of rows that are counted.
pub const MOST_ROWS: usize = 50_000_000;

/// Shares of values in bins of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Where the first bin begins, SI.
    pub from: f64,
    /// Width of a bin, SI.
    pub width: f64,
    /// Share of the values in each bin, %; they add up to 100 unless there is no value.
    pub shares: Vec<f64>,
}

impl Histogram {
    /// Counts the values of some rows in bins between two values, both included. Values outside of them and missing ones do not count.
    ///
    /// # Errors
    /// When there are more than [`MOST_ROWS`], or the work was cancelled; one sentence.
    pub fn new(
        (samples, channel): (&Samples, usize),
        rows: Range<usize>,
        ([low, high], bins): ([f64; 2], usize),
        handle: &Handle,
    ) -> Result<Self, String> {
        if rows.len() > MOST_ROWS {
            return Err(format!(
                "{} samples are in sight and at most {MOST_ROWS} are counted; zoom in",
                rows.len()
            ));
        }
        let bins = bins.max(1);
        // All values of a constant channel are in the middle bin.
        let (from, width) = if high > low {
            (low, (high - low) / bins as f64)
        } else {
            let width = 1e-3 * low.abs().max(1e-3);
            (low - 0.5 * width * bins as f64, width)
        };
        let (mut counts, mut total) = (vec![0_u64; bins], 0_u64);
        let mut next = rows.start;
        while next < rows.end {
            handle.reached((next - rows.start) as f32 / rows.len() as f32)?;
            let block = next..(next + BLOCK).min(rows.end);
            next = block.end;
            for value in samples.values(channel, block) {
                // The cast of what lies below the first bin is 0.
                let place = ((value - from) / width).floor();
                if place >= 0.0 && value <= from + width * bins as f64 * (1.0 + f64::EPSILON) {
                    counts[(place as usize).min(bins - 1)] += 1;
                    total += 1;
                }
            }
        }
        let share = |count: u64| if total == 0 { 0.0 } else { 100.0 * count as f64 / total as f64 };
        Ok(Self { from, width, shares: counts.into_iter().map(share).collect() })
    }

    /// The outline as a line of steps, values times a factor.
    #[must_use]
    pub fn outline(&self, factor: f64) -> Vec<[f64; 2]> {
        let edge = |bin: usize| factor * (self.from + self.width * bin as f64);
        let mut line = vec![[edge(0), 0.0]];
        for (bin, share) in self.shares.iter().enumerate() {
            line.extend([[edge(bin), *share], [edge(bin + 1), *share]]);
        }
        line.push([edge(self.shares.len()), 0.0]);
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_recording::{Channel, Dataset, Unit};

    fn of(values: Vec<f64>, range: [f64; 2]) -> Histogram {
        let time_s: Vec<f64> = (0..values.len()).map(|row| row as f64).collect();
        let channels = vec![Channel::new("x", Unit::V)];
        let data = Dataset::from_columns("r", channels, time_s.clone(), vec![values.clone()]).unwrap();
        let samples = Samples::in_memory(time_s, &[values], data.segments().to_vec());
        Histogram::new((&samples, 0), 0..samples.rows(), (range, 4), &Handle::default()).unwrap()
    }

    #[test]
    fn every_value_is_in_one_bin_and_missing_ones_in_none() {
        let found = of(vec![0.0, 0.9, 1.0, 4.0, f64::NAN, 3.5, 2.0, 1.5, -7.0], [0.0, 4.0]);
        assert_eq!((found.from, found.width), (0.0, 1.0));
        let expected = [2.0, 2.0, 1.0, 2.0].map(|count| count / 7.0 * 100.0);
        assert!(
            found.shares.iter().zip(expected).all(|(share, own)| (share - own).abs() < 1e-9),
            "{found:?}"
        );
        let outline = found.outline(60.0);
        assert_eq!((outline[0], outline[2], outline[9]), ([0.0, 0.0], [60.0, found.shares[0]], [240.0, 0.0]));
    }

    #[test]
    fn a_constant_channel_has_one_full_bin() {
        let found = of(vec![5.0; 10], [5.0, 5.0]);
        assert_eq!(found.shares.iter().filter(|share| **share == 100.0).count(), 1, "{found:?}");
        assert_eq!(found.shares.iter().sum::<f64>(), 100.0);
    }
}
