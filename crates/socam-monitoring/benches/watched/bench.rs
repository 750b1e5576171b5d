//! Simulated benches for monitoring: they differ from their model, and some sensors have coloured noise.

use socam_model::Model;
use socam_recording::{Dataset, ProfileFile};
use socam_sim::{Concealed, Override, Setup, Truth, calibration_for};
use socam_tests::Draw;

/// Parameters that differ from the model's, and the largest relative difference.
const UNLIKE: [&str; 6] = ["k1", "k2", "k4", "c3", "c4", "c5"];
const BY: f64 = 0.01;
/// Standard deviation of the coloured noise of an output over that of its white noise, and the correlation of successive samples.
const COLOURED: f64 = 0.5;
const CORRELATION: f64 = 0.95;
/// Sampling interval, us.
const PERIOD_US: u32 = 2500;

/// A bench with its own parameters for each number.
pub(crate) struct Bench {
    pub(crate) model: Model,
    healthy: Vec<Override>,
    profile: &'static str,
    seed: u64,
    number: u64,
}

/// A change in the middle of a run.
pub(crate) enum Change {
    Effect(String),
    /// A parameter, times a factor.
    Parameter(&'static str, f64),
}

impl Bench {
    pub(crate) fn new(seed: u64, number: u64) -> Self {
        let mut draw = Draw::new(seed, number);
        let model = Model::builtin("speed-o-cam").expect("an embedded model");
        let healthy = UNLIKE.map(|name| {
            let index = model.parameter(name).expect("a parameter of the model");
            Override {
                name: name.into(),
                value: model.values()[index] * (1.0 + BY * draw.between(-1.0, 1.0)),
            }
        });
        let profile = ["multisine", "prbs", "chirp"][draw.whole(0, 2) as usize];
        Self { model, healthy: healthy.to_vec(), profile, seed, number }
    }

    /// Records `duration_s` seconds; each `run` has different noise. The change begins at the time given with it, s.
    pub(crate) fn record(
        &self,
        run: u64,
        duration_s: f64,
        change: Option<(&Change, f64)>,
    ) -> Result<Dataset, String> {
        let truth = |overrides: &[Override], hidden: &[Concealed]| {
            Truth::new(&self.model, overrides, hidden).map_err(|error| error.to_string())
        };
        let before = truth(&self.healthy, &[])?;
        let (mut overrides, mut hidden) = (self.healthy.clone(), Vec::new());
        match change.map(|(change, _)| change) {
            Some(Change::Effect(text)) => {
                hidden.push(text.parse().map_err(|e: socam_sim::SimError| e.to_string())?)
            }
            Some(Change::Parameter(name, factor)) => {
                let index = self.model.parameter(name).ok_or("no such parameter")?;
                let value = factor * before.values[index];
                overrides.push(Override { name: (*name).into(), value });
            }
            None => {}
        }
        let noise_seed = self.seed.wrapping_mul(1_000_003) + 1000 * self.number + run;
        let calibration = calibration_for(&self.model);
        let mut setup = Setup::new(truth(&overrides, &hidden)?, calibration, noise_seed);
        setup.before = change.map(|(_, at_s)| (before, at_s));
        let file = ProfileFile::open(self.profile).map_err(|error| error.to_string())?;
        let profile =
            ProfileFile { duration_s, ..file }.profile(PERIOD_US).map_err(|error| error.to_string())?;
        let data = setup.record("run", &profile, PERIOD_US).map_err(|error| error.to_string())?;
        coloured(&setup, &data, &mut Draw::new(noise_seed, 77))
    }
}

/// The recording with coloured noise added to every channel that has a sensor.
fn coloured(setup: &Setup, data: &Dataset, draw: &mut Draw) -> Result<Dataset, String> {
    let loaded = data.load_all().map_err(|error| error.to_string())?;
    let outputs = setup.truth.model.outputs().map(|output| output.column.as_str()).collect::<Vec<_>>();
    let columns = loaded.columns.iter().zip(data.channels()).map(|(column, channel)| {
        let name = channel.column_name();
        let std = setup.noise_std_of_column(&name).filter(|_| outputs.contains(&name.as_str()));
        let (std, mut state) = (COLOURED * std.unwrap_or(0.0), 0.0);
        let noisy = column.values().iter().map(|value| {
            state = CORRELATION * state + (1.0 - CORRELATION * CORRELATION).sqrt() * draw.normal();
            value + std * state
        });
        noisy.collect()
    });
    let columns = columns.collect();
    Dataset::from_columns("run", data.channels().to_vec(), loaded.time_s, columns)
        .map_err(|error| error.to_string())
}
