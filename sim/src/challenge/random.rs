//! Random draws of a case.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The random stream of a case.
pub(super) struct Draw(ChaCha8Rng);

impl Draw {
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(stream);
        Self(random)
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    /// Log-uniform.
    pub(super) fn log(&mut self, (low, high): (f64, f64)) -> f64 {
        low * (high / low).powf(self.between(0.0, 1.0))
    }

    /// Log-uniform from 1/`spread` to `spread`.
    pub(super) fn factor(&mut self, spread: f64) -> f64 {
        self.log((1.0 / spread, spread))
    }

    pub(super) fn whole(&mut self, low: u64, high: u64) -> u64 {
        self.0.random_range(low..=high)
    }

    pub(super) fn chance(&mut self, part: f64) -> bool {
        self.between(0.0, 1.0) < part
    }

    pub(super) fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    pub(super) fn phase_rad(&mut self) -> f64 {
        self.between(0.0, std::f64::consts::TAU)
    }

    pub(super) fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.whole(0, list.len() as u64 - 1) as usize]
    }

    /// Standard normal.
    pub(super) fn normal(&mut self) -> f64 {
        self.0.sample(rand_distr::StandardNormal)
    }

    pub(super) fn seed(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// The list in random order (Fisher and Yates).
    pub(super) fn shuffled<T: Copy>(&mut self, list: &[T]) -> Vec<T> {
        let mut list = list.to_vec();
        for last in (1..list.len()).rev() {
            list.swap(last, self.whole(0, last as u64) as usize);
        }
        list
    }
}
