//! The bench at its connectors: voltages in and out at any time, for a board with its own converters.

use crate::SimError;
use crate::bench::Bench;
use crate::gearmotor::GearmotorPins;
use crate::setup::Setup;

/// Noise of one conversion over that of a sample, which is a triangular mean over two intervals of four conversions: one over
/// the root of the sum of the squared weights, 44 / 256.
const OF_ONE_CONVERSION: f64 = 2.412_090_756_622_109;

/// A running bench.
pub struct Analog<'p> {
    bench: Bench<'p>,
    channels: usize,
}

impl Analog<'_> {
    /// Builds the bench, at rest at time 0, and hands it to `serve`. Each reading has the noise of a single conversion, such
    /// that a sample, the usual mean of conversions, has the noise of the setup.
    ///
    /// # Errors
    /// [`SimError`] where the bench cannot be built.
    pub fn run<T>(setup: &Setup, serve: impl FnOnce(&mut Analog<'_>) -> T) -> Result<T, SimError> {
        let mut setup = setup.clone();
        setup.noise_std = setup.noise_of_conversions(OF_ONE_CONVERSION);
        let plants = setup.plants()?;
        let mut analog =
            Analog { bench: Bench::start(&setup, &plants)?, channels: setup.calibration.channels.len() };
        Ok(serve(&mut analog))
    }

    /// Number of sensors.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Sets command voltage and enable line from `at_s` on.
    ///
    /// # Errors
    /// [`SimError::Solver`] when the simulation failed.
    pub fn command(&mut self, at_s: f64, volts: f64, enabled: bool) -> Result<(), SimError> {
        self.bench.pass(at_s)?;
        self.bench.command(volts, enabled);
        Ok(())
    }

    /// The sensors' voltages at `at_s`, which must not be before the previous call's time.
    ///
    /// # Errors
    /// [`SimError::Solver`] when the simulation failed.
    pub fn voltages(&mut self, at_s: f64, volts: &mut [f64]) -> Result<(), SimError> {
        self.bench.voltages(at_s, volts)
    }

    /// Lets time pass up to `at_s` with a gearmotor's bridge at a duty of -1 to 1 (0 brakes), or off; `None` where the bench is no gearmotor.
    ///
    /// # Errors
    /// [`SimError::Solver`] when the simulation failed.
    pub fn bridge(&mut self, at_s: f64, duty: Option<f64>) -> Result<Option<GearmotorPins>, SimError> {
        self.bench.bridge(at_s, duty)
    }
}

#[cfg(test)]
mod tests {
    use socam_model::Model;
    use socam_recording::Calibration;

    use super::*;
    use crate::Truth;

    /// Readings of a slow tachometer every 0.25 ms. With `again`, the command is given twice in between, the second time 0.06 ms
    /// later.
    fn read(again: bool) -> Vec<f64> {
        let lag = "sensor_lag@motor_speed:time_constant=0.002".parse().unwrap();
        let truth = Truth::new(&Model::builtin("speed-o-cam").unwrap(), &[], &[lag]).unwrap();
        let mut setup = Setup::new(truth, Calibration::default(), 1);
        setup.noisy = false;
        let read = Analog::run(&setup, |bench| {
            let mut volts = vec![0.0; bench.channels()];
            let mut one = |reading: u32| {
                let at_s = f64::from(reading) * 250e-6;
                bench.voltages(at_s, &mut volts).unwrap();
                bench.command(at_s, 1.0, true).unwrap();
                if again {
                    bench.command(at_s + 60e-6, 1.0, true).unwrap();
                }
                volts[0]
            };
            (1..200).map(&mut one).collect()
        });
        read.unwrap()
    }

    #[test]
    fn a_sensors_lag_does_not_depend_on_when_commands_come() {
        let (once, twice) = (read(false), read(true));
        assert!(once[198] > 0.1);
        for (a, b) in once.iter().zip(&twice) {
            assert!((a - b).abs() < 1e-5, "{a}, {b}");
        }
    }
}
