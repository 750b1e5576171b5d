//! Sensors: from true values to voltages with noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use socam_core::scaling::Converter;
use socam_recording::CalibratedChannel;

/// Standard deviations of the default bench's sensors, SI.
const KNOWN_NOISE: [(&str, f64); 5] = [
    ("motor_speed", 0.02),
    ("output_speed", 0.01),
    ("torque_in", 2e-3),
    ("torque_out", 1e-2),
    ("motor_current", 5e-3),
];

/// Standard deviation of any other sensor, relative to its full scale.
const OTHER_NOISE: f64 = 1e-4;

/// One sensor with its amplifier and converter input.
#[derive(Debug)]
pub(crate) struct Sensor {
    calibration: socam_core::scaling::Sensor,
    noise: Option<Normal<f64>>,
    random: ChaCha8Rng,
}

impl Sensor {
    /// The sensor of a channel. Every channel has its own random stream, so that adding a channel does not change the noise of others.
    pub(crate) fn new(channel: &CalibratedChannel, seed: u64, stream: u64, noise_std: f64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(stream);
        let noise = Normal::new(0.0, noise_std).ok().filter(|_| noise_std > 0.0);
        Self { calibration: channel.sensor, noise, random }
    }

    /// The voltage for a true value, SI.
    pub(crate) fn volts(&mut self, value: f64) -> f64 {
        let noise = self.noise.map_or(0.0, |noise| noise.sample(&mut self.random));
        self.calibration.volts(value + noise)
    }
}

/// Default standard deviation of a sensor's noise before its converter, SI.
pub(crate) fn noise_std(channel: &CalibratedChannel, converter: &Converter) -> f64 {
    let known = KNOWN_NOISE.iter().find(|(name, _)| *name == channel.channel.name);
    known.map_or(OTHER_NOISE * converter.full_scale_v / channel.sensor.volts_per_unit.abs(), |(_, std)| *std)
}
