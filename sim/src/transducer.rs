//! A virtual torque transducer behind an HX711, as a gearmotor board has it: slow conversions, each the mean of the torque over four
//! conversion times.
//!
//! The data sheet gives the time in which the converter settles, four conversions, and not its filter. A mean over this time settles in it
//! exactly, and delays by half of it.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use socam_core::transducer::{NO_CONVERSION, RAILS};

/// Time between conversions, s.
const CONVERSION_S: f64 = 1.0 / 80.0;

/// Conversion times of the mean.
const SETTLING: usize = 4;

/// Standard deviation of a conversion at a gain of 128 and a supply of 3.3 V: 90 nV (data sheet), in codes.
const NOISE_CODES: f64 = 58.0;

/// The running transducer. What it is given is a number of codes.
pub(crate) struct Transducer {
    /// Time, and integral of the codes, at the latest conversions, oldest first.
    marks: [(f64, f64); SETTLING + 1],
    at_s: f64,
    codes: f64,
    integral: f64,
    next_s: f64,
    noise: Option<Normal<f64>>,
    random: ChaCha8Rng,
}

impl Transducer {
    /// A transducer at time 0. Its noise has a stream of its own.
    pub(crate) fn new(seed: u64, noisy: bool) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(u64::from(u32::MAX));
        Self {
            marks: [(0.0, 0.0); SETTLING + 1],
            at_s: 0.0,
            codes: 0.0,
            integral: 0.0,
            next_s: CONVERSION_S,
            noise: Normal::new(0.0, NOISE_CODES).ok().filter(|_| noisy),
            random,
        }
    }

    /// The torque at a time, in codes; returns the count of the sample that ends there.
    pub(crate) fn step(&mut self, at_s: f64, codes: f64) -> i32 {
        self.integral += 0.5 * (self.codes + codes) * (at_s - self.at_s);
        (self.at_s, self.codes) = (at_s, codes);
        // Conversions have a clock of their own; a sample sees one when it has come.
        if at_s < self.next_s {
            return NO_CONVERSION;
        }
        self.next_s += CONVERSION_S * ((at_s - self.next_s) / CONVERSION_S).floor().max(0.0) + CONVERSION_S;
        self.marks.rotate_left(1);
        let since = self.marks[0];
        self.marks[SETTLING] = (at_s, self.integral);
        let noise = self.noise.map_or(0.0, |noise| noise.sample(&mut self.random));
        let mean = (self.integral - since.1) / (at_s - since.0);
        let [highest, lowest] = RAILS.map(f64::from);
        (mean + noise).round().clamp(lowest, highest) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conversion_is_a_mean_of_50_ms_and_comes_every_twelfth_or_thirteenth_sample() {
        let mut transducer = Transducer::new(1, false);
        // A ramp of a code per millisecond is read 25 ms late.
        let read: Vec<(usize, i32)> = (1..=1000)
            .map(|sample| (sample, transducer.step(sample as f64 * 1e-3, sample as f64)))
            .filter(|(_, code)| *code != NO_CONVERSION)
            .collect();
        assert_eq!(read.len(), 80);
        assert!(read.windows(2).all(|pair| (12..=13).contains(&(pair[1].0 - pair[0].0))), "{read:?}");
        assert!(read[4..].iter().all(|(sample, code)| (*sample as i32 - code - 25).abs() <= 1), "{read:?}");
        assert_eq!(Transducer::new(1, false).step(1.0, 1e9), RAILS[0]);
    }
}
