//! Averages conversions to samples.
//!
//! A sample is the triangular mean of the conversions of the last two sampling intervals: weights 1, 2, 3, 4, 3, 2, 1, 0 with four
//! conversions per interval. This suppresses aliases from around the sampling frequency, and the mean is centred on the tick before
//! the sample. Even and odd conversions have the same total weight, so a converter that scans its channels alternately forwards and
//! backwards samples all of them at the same mean instant.

use crate::MAX_CHANNELS;
use crate::triangle::{Interval, Triangle};

/// Longest time between two conversions, also when sampling is slow.
const LONGEST_STEP_US: u32 = 500;

/// Shortest sampling interval with four conversions; a shorter one has two.
const FOUR_FROM_US: u32 = 400;

/// Number of conversions in a sampling interval: a power of two, at least 2.
pub fn conversions_per_sample(sample_period_us: u32) -> u32 {
    let steps = sample_period_us.div_ceil(LONGEST_STEP_US).checked_next_power_of_two().unwrap_or(1);
    steps.max(if sample_period_us < FOUR_FROM_US { 2 } else { 4 })
}

/// The running means of a converter's channels.
#[derive(Debug, Clone, Copy)]
pub struct Average {
    channels: usize,
    interval: Interval,
    triangles: [Triangle; MAX_CHANNELS],
    mean: [i16; MAX_CHANNELS],
}

impl Average {
    /// An average of `channels` channels without conversions. The first sample lacks its earlier half.
    pub fn new(sample_period_us: u32, channels: u8) -> Self {
        Self {
            channels: usize::from(channels),
            interval: Interval::new(conversions_per_sample(sample_period_us).trailing_zeros()),
            triangles: [Triangle::default(); MAX_CHANNELS],
            mean: [0; MAX_CHANNELS],
        }
    }

    /// Number of the next conversion within its interval, from 0.
    pub fn position(&self) -> u32 {
        self.interval.position()
    }

    /// Adds a conversion; returns whether it completes a sample.
    pub fn push(&mut self, counts: &[i16; MAX_CHANNELS]) -> bool {
        for (triangle, &count) in self.triangles.iter_mut().zip(counts).take(self.channels) {
            triangle.push(count.into());
        }
        let Some(log2) = self.interval.step() else { return false };
        for (triangle, mean) in self.triangles.iter_mut().zip(&mut self.mean).take(self.channels) {
            *mean = triangle.complete(log2) as i16;
        }
        true
    }

    /// The latest sample.
    pub fn sample(&self) -> &[i16; MAX_CHANNELS] {
        &self.mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn samples(period_us: u32, conversions: impl Iterator<Item = i16>) -> Vec<i16> {
        let mut average = Average::new(period_us, 8);
        let mut samples = Vec::new();
        for count in conversions {
            if average.push(&[count; MAX_CHANNELS]) {
                samples.push(average.sample()[7]);
            }
        }
        samples
    }

    #[test]
    fn a_sample_is_a_triangle_over_two_intervals() {
        // One conversion of 1600 in an otherwise silent stream finds its weight, in sixteenths.
        let weight = |at: usize| samples(1000, (0..12).map(|i| if i == at { 1600 } else { 0 }))[2];
        let weights: Vec<i16> = (4..12).map(weight).collect();
        assert_eq!(weights, [100, 200, 300, 400, 300, 200, 100, 0]);
        let weight = |at: usize| samples(200, (0..6).map(|i| if i == at { 400 } else { 0 }))[2];
        assert_eq!([weight(2), weight(3), weight(4), weight(5)], [100, 200, 100, 0]);
    }

    #[test]
    fn forth_and_back_in_turns_puts_all_channels_at_one_instant() {
        // A ramp, read by a converter that takes channel 0 first on even conversions and last on odd ones.
        for period_us in [200, 1000, 100_000] {
            let mut average = Average::new(period_us, 8);
            let mut conversion = 0i16;
            loop {
                let early = conversion * 8;
                let counts = core::array::from_fn(|channel| {
                    let place = if conversion % 2 == 0 { channel } else { MAX_CHANNELS - 1 - channel };
                    early + place as i16
                });
                let is_whole = average.push(&counts);
                conversion += 1;
                if is_whole && conversion as u32 >= 3 * conversions_per_sample(period_us) {
                    break;
                }
            }
            let [first, .., last] = *average.sample();
            assert_eq!(first, last, "{period_us} us");
        }
    }

    #[test]
    fn full_scale_stays_full_scale_at_any_rate() {
        for period_us in [50, 100, 200, 400, 1000, 3000, 1_000_000] {
            let count = 3 * conversions_per_sample(period_us) as usize;
            for full in [i16::MIN, i16::MAX, -1] {
                let samples = samples(period_us, core::iter::repeat_n(full, count));
                assert_eq!(samples[1..], [full, full], "{period_us} us");
            }
            assert!(period_us / conversions_per_sample(period_us) <= LONGEST_STEP_US);
        }
    }
}
