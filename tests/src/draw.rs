//! Random numbers for benchmarks that draw cases.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Every case draws from a stream of its own, whichever others are drawn.
#[derive(Debug)]
pub struct Draw(ChaCha8Rng);

impl Draw {
    /// The stream of case `number` of those that belong to a seed.
    #[must_use]
    pub fn new(seed: u64, number: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(number);
        Self(random)
    }

    /// A number from `low` to `high` with uniform density.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    /// A whole number from `low` to `high`, both included.
    pub fn whole(&mut self, low: u64, high: u64) -> u64 {
        self.0.random_range(low..=high)
    }

    /// Whether what happens in this part of cases happens in this one.
    pub fn chance(&mut self, part: f64) -> bool {
        self.between(0.0, 1.0) < part
    }

    /// A factor from 1/`spread` to `spread`, as likely below one as above.
    pub fn factor(&mut self, spread: f64) -> f64 {
        spread.powf(self.between(-1.0, 1.0))
    }

    /// A normal number of mean 0 and variance 1.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Seed of a generator of its own.
    pub fn seed(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Any of a list.
    pub fn one_of<'l>(&mut self, list: &[&'l str]) -> &'l str {
        list[self.whole(0, list.len() as u64 - 1) as usize]
    }
}
