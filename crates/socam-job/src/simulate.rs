//! The virtual bench on a profile, and a model driven by the inputs of a recording.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use socam_identify::{Local, Options, Problem};
use socam_model::Model;
use socam_recording::{Calibration, Dataset, ProfileFile};
use socam_sim::{
    Begin, Concealed, Disturbance, OutputError, Override, Replay, SimError, Start, Truth, calibration_for,
};

use crate::error::{JobError, Result};
use crate::grid::Grid;
use crate::model::{BETWEEN_HELP, MODEL_HELP, load_model, set_between};
use crate::notation::{self, seconds, text_of};
use crate::options::Settings;
use crate::record::Record;

/// What the virtual bench really is
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct VirtualBench {
    /// Name of an embedded model, or path of a model file.
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = MODEL_HELP)]
    pub model: String,
    /// Let a parameter of the virtual bench differ from the model's: NAME=VALUE in SI, as in k1=71; may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = text_of::<Override>)]
    #[serde(deserialize_with = "notation::texts")]
    pub values: Vec<String>,
    /// Conceal physics in the virtual bench that the model does not name, in SI, as in coulomb_friction@load_bearing:torque=0.4 or
    /// sensor_gain@torque_out:gain=0.98; may be repeated
    #[arg(long, value_name = "EFFECT@PLACE:name=value,..", value_parser = text_of::<Concealed>)]
    #[serde(deserialize_with = "notation::texts")]
    pub hide: Vec<String>,
    /// Let --set and --hide begin in mid-run, so long after the drive was enabled, as in 20s [default: from the start]
    #[arg(long = "begin-at", value_name = "TIME", value_parser = seconds)]
    pub begin_at_s: Option<f64>,
    /// Another number, other noise of the sensors
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Take all noise from the sensors
    #[arg(long = "no-noise", action = clap::ArgAction::SetFalse)]
    pub noise: bool,
}

impl VirtualBench {
    /// The true drivetrain of a model.
    ///
    /// # Errors
    /// When the model has no such parameter, effect or place.
    pub fn truth(&self, model: &Model) -> Result<Truth> {
        let values = self.values.iter().map(|text| text.parse::<Override>());
        let hidden = self.hide.iter().map(|text| text.parse::<Concealed>());
        let wrong = |error: SimError| JobError::Inputs(error.to_string());
        let values = values.collect::<std::result::Result<Vec<_>, _>>().map_err(wrong)?;
        let hidden = hidden.collect::<std::result::Result<Vec<_>, _>>().map_err(wrong)?;
        Truth::new(model, &values, &hidden).map_err(wrong)
    }

    /// The whole bench of a model, with the sensors of `calibration`, or by default those for the model.
    ///
    /// # Errors
    /// The errors of [`VirtualBench::truth`], and an error when a change in mid-run changes nothing.
    pub fn setup(&self, model: &Model, calibration: Option<Calibration>) -> Result<socam_sim::Setup> {
        let truth = self.truth(model)?;
        let calibration = calibration.unwrap_or_else(|| calibration_for(&truth.model));
        let mut setup = socam_sim::Setup::new(truth, calibration, self.seed);
        setup.noisy = self.noise;
        if let Some(begin_s) = self.begin_at_s {
            if !self.describes_a_change() {
                return Err(JobError::value(
                    "begin_at_s",
                    "--begin-at",
                    " needs a --set or --hide that begins then",
                ));
            }
            setup.before = Some((Truth::new(model, &[], &[])?, begin_s));
        }
        Ok(setup)
    }

    /// The written model of the bench.
    ///
    /// # Errors
    /// When there is no such model, or its file has a mistake.
    pub fn load(&self) -> Result<Model> {
        load_model(&self.model)
    }

    /// Whether any option except the model is set; these options apply only to a virtual bench.
    #[must_use]
    pub fn describes_a_bench(&self) -> bool {
        self.describes_a_change() || !self.noise || self.begin_at_s.is_some()
    }

    fn describes_a_change(&self) -> bool {
        !self.values.is_empty() || !self.hide.is_empty()
    }
}

/// Settings of a simulation
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Simulate {
    /// What is run.
    #[command(flatten)]
    #[serde(flatten)]
    pub record: Record,
    /// A column of that recording that acts in addition to the model's inputs: a torque (N m) or force (N) on a node, or V on a servo's drive
    #[arg(long, value_name = "COLUMN@PLACE", value_parser = text_of::<Disturbance>)]
    #[serde(deserialize_with = "notation::texts")]
    pub disturb: Vec<String>,
    /// `KIND` for all inputs or `INPUT=KIND` for one.
    #[arg(long, value_name = "[INPUT=]KIND", help = BETWEEN_HELP)]
    #[serde(deserialize_with = "notation::texts")]
    pub between: Vec<String>,
    /// Start at rest [default: start states that fit the whole recording best]
    #[arg(long)]
    pub from_rest: bool,
    /// What it is run on.
    #[command(flatten)]
    #[serde(flatten)]
    pub bench: VirtualBench,
}

impl Settings for Simulate {
    const COMMAND: &'static [&'static str] = &["simulate"];

    fn validate(&self) -> Result<()> {
        self.record.validate()
    }
}

/// A model that was driven by a recording's inputs.
#[derive(Debug)]
pub struct Replayed {
    /// The model's inputs and predicted outputs.
    pub simulated: Dataset,
    /// How they differ from the measurement.
    pub document: ReplayDocument,
}

impl Simulate {
    /// Runs a profile on the virtual bench of a model, in memory.
    ///
    /// # Errors
    /// When profile, rate or bench is invalid, or the bench ends the run.
    pub fn run(&self, model: &Model, profile: ProfileFile, name: String) -> Result<Dataset> {
        let period_us = self.record.period_us()?;
        let profile = self.record.lasting(profile)?.profile(period_us)?;
        Ok(self.bench.setup(model, None)?.record(name, &profile, period_us)?)
    }

    /// Drives the model by the inputs of a recording; `open` puts the recording on the grid that it is given.
    ///
    /// # Errors
    /// When the recording lacks an input, or the bench cannot be simulated.
    pub fn replay(
        &self,
        model: &Model,
        open: impl FnOnce(Grid<'_>) -> Result<Dataset>,
    ) -> Result<(Dataset, Replayed)> {
        let mut truth = self.bench.truth(model)?;
        set_between(&mut truth.model, &self.between)?;
        let data = open(Grid::Even(&truth.model))?;
        // Without the outputs, or far from the recording, nothing is settled.
        if let Ok(settled) =
            socam_identify::settled_inputs(&truth.model, std::slice::from_ref(&data), Options::default())
        {
            truth.model = settled;
        }
        let disturbances: std::result::Result<Vec<Disturbance>, _> =
            self.disturb.iter().map(|text| text.parse()).collect();
        let disturbances = disturbances?;
        // The fit of start states knows the inputs of the model only, not disturbances.
        let start = match (self.from_rest, disturbances.is_empty()) {
            (true, _) => Start::Rest,
            (false, true) => fitted_start(&truth, &data),
            (false, false) => Start::Fitted,
        };
        let replay = Replay { truth, disturbances, start };
        let replayed = replay.run(&data)?;
        let document = ReplayDocument::new(&replay.truth.model, data.name(), self.from_rest, &replayed);
        let socam_sim::Replayed { columns, time_s, values, .. } = replayed;
        let simulated = Dataset::from_columns(data.name(), columns, time_s, values)?;
        Ok((data, Replayed { simulated, document }))
    }
}

/// Start states that fit the whole recording best, as an identification estimates them; if it cannot (for example without the model's
/// outputs), those that the simulator computes.
fn fitted_start(truth: &Truth, data: &Dataset) -> Start {
    let problem = Problem::of_known(&truth.model, std::slice::from_ref(data), Options::default());
    let fitted = problem.and_then(|problem| socam_identify::start_states(&problem, &truth.values));
    let begin = |Local { first_row, states, offsets, .. }: Local| Begin { first_row, states, offsets };
    fitted.map_or(Start::Fitted, |fitted| Start::Given(fitted.into_iter().map(begin).collect()))
}

/// The document `socam.comparison/1`: a model driven by a recording's inputs, compared with the recording.
#[derive(Debug, Clone, Serialize)]
pub struct ReplayDocument {
    schema: &'static str,
    /// Name of the model.
    pub model: String,
    /// Name of the recording.
    pub input: String,
    /// The file that holds the simulated recording.
    pub output: Option<String>,
    /// How each input moves between its samples.
    pub between: BTreeMap<String, &'static str>,
    start: &'static str,
    /// Number of rows.
    pub rows: usize,
    /// The model's outputs that were measured, too.
    pub channels: Vec<ChannelError>,
}

/// How a predicted channel differs from the measured one, SI.
#[derive(Debug, Clone, Serialize)]
pub struct ChannelError {
    /// Its name.
    pub channel: String,
    /// Its unit.
    pub unit: &'static str,
    samples: usize,
    /// Root mean square of the error.
    pub rms: f64,
    /// Largest error.
    pub max: f64,
    /// Root mean square of the error in percent of the channel's standard deviation.
    pub relative_percent: f64,
}

impl ReplayDocument {
    fn new(model: &Model, input: &str, from_rest: bool, replayed: &socam_sim::Replayed) -> Self {
        let kinds = model.inputs().filter(|input| !input.quantity.is_clock());
        Self {
            schema: "socam.comparison/1",
            model: model.name.clone(),
            input: input.to_owned(),
            output: None,
            between: kinds.map(|input| (input.name.clone(), input.intersample().name())).collect(),
            start: if from_rest { "rest" } else { "fitted" },
            rows: replayed.time_s.len(),
            channels: replayed.errors.iter().map(ChannelError::from).collect(),
        }
    }
}

impl From<&OutputError> for ChannelError {
    fn from(error: &OutputError) -> Self {
        Self {
            channel: error.channel.clone(),
            unit: error.unit,
            samples: error.samples,
            rms: error.rms,
            max: error.max,
            relative_percent: error.relative_percent,
        }
    }
}
