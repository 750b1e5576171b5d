//! The bench at its connectors: voltages in and out at any time, for a board that brings converters of its own.

use crate::SimError;
use crate::bench::{Bench, Setup};

/// Noise of one conversion over that of a sample, which is a triangular mean over two intervals of four conversions: one over
/// the root of the sum of the squared weights, 44 / 256.
const OF_ONE_CONVERSION: f64 = 2.412_090_756_622_109;

/// A bench in motion.
pub struct Analog<'p> {
    bench: Bench<'p>,
    channels: usize,
}

impl Analog<'_> {
    /// Builds the bench, at rest at time 0, and hands it to `serve`. Each reading has the noise of a single conversion: so much
    /// that a sample of the usual means has the noise of the setup.
    ///
    /// # Errors
    /// [`SimError`] where the bench cannot be built.
    pub fn run<T>(setup: &Setup, serve: impl FnOnce(&mut Analog<'_>) -> T) -> Result<T, SimError> {
        let mut setup = setup.clone();
        setup.noise_std = setup.noise_of_conversions(OF_ONE_CONVERSION);
        let plant = setup.plant()?;
        let mut analog =
            Analog { bench: Bench::start(&setup, &plant)?, channels: setup.calibration.channels.len() };
        Ok(serve(&mut analog))
    }

    /// How many sensors there are.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Command voltage and enable line, from `at_s` on.
    ///
    /// # Errors
    /// [`SimError::Solver`] when the simulation failed.
    pub fn command(&mut self, at_s: f64, volts: f64, enabled: bool) -> Result<(), SimError> {
        self.bench.pass(at_s)?;
        self.bench.command(volts, enabled);
        Ok(())
    }

    /// The sensors' voltages at `at_s`, which may not lie before what was asked last.
    ///
    /// # Errors
    /// [`SimError::Solver`] when the simulation failed.
    pub fn voltages(&mut self, at_s: f64, volts: &mut [f64]) -> Result<(), SimError> {
        self.bench.voltages(at_s, volts)
    }
}
