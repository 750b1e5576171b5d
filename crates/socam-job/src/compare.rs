//! Comparison of a recording with the output of a simulator.

use serde::{Deserialize, Serialize};
use socam_compare::{Comparison, Document, ModelCheck, Options};
use socam_model::Model;
use socam_recording::Dataset;
use socam_sim::{Replay, Start, Truth};

use crate::error::{JobError, Result};
use crate::model::MODEL_HELP;
use crate::notation;
use crate::options::Settings;
use crate::rules::check_false_alarm_rate;

/// Settings of a comparison
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Compare {
    /// Compare a simulated channel with a measured one of another name; may be repeated
    #[arg(long = "map", value_name = "SIMULATED=MEASURED")]
    #[serde(deserialize_with = "notation::texts")]
    pub names: Vec<String>,
    /// Seconds to add to the simulation's times
    #[arg(long = "offset", value_name = "SECONDS", default_value_t = 0.0, allow_hyphen_values = true)]
    pub offset_s: f64,
    /// False alarm rate, 0 to 1: share of right simulations of which a difference is reported
    #[arg(long, value_name = "P", default_value_t = 0.01)]
    pub false_alarm_rate: f64,
    /// Name of an embedded model, or path of a model file.
    #[arg(long, value_name = "MODEL", help = MODEL_HELP)]
    pub model: Option<String>,
}

impl Settings for Compare {
    const COMMAND: &'static [&'static str] = &["compare"];

    fn validate(&self) -> Result<()> {
        check_false_alarm_rate(self.false_alarm_rate)?;
        if !self.offset_s.is_finite() {
            let problem = format!(" {}: expected seconds", self.offset_s);
            return Err(JobError::value("offset_s", "--offset", problem));
        }
        Ok(())
    }
}

/// A recording compared with a simulation.
#[derive(Debug)]
pub struct Compared {
    /// Differences between them.
    pub comparison: Comparison,
    /// Comparison of the given simulation with that of a model.
    pub model: Option<ModelCheck>,
}

impl Compared {
    /// The document `socam.compare/1`.
    #[must_use]
    pub fn document(&self) -> Document<'_> {
        Document::new(&self.comparison, self.model.clone())
    }
}

impl Compare {
    /// Compares a recording on the grid [`View`](crate::Grid::View) with a simulation, and this simulation with that of a model, which is
    /// driven by the recording's inputs on the grid [`Even`](crate::Grid::Even).
    ///
    /// # Errors
    /// When they have no channel or too little time in common, or the model cannot be simulated.
    pub fn run(
        &self,
        recording: &Dataset,
        simulation: Dataset,
        driven: Option<(&Model, &Dataset)>,
    ) -> Result<Compared> {
        let simulation = socam_compare::shifted(simulation, self.offset_s)?;
        let comparison = self.pair(recording, &simulation)?;
        let model = driven.map(|(model, inputs)| self.check(model, inputs, &simulation)).transpose()?;
        Ok(Compared { comparison, model })
    }

    fn pair(&self, one: &Dataset, other: &Dataset) -> Result<Comparison> {
        let options = Options { false_alarm_rate: self.false_alarm_rate };
        Ok(socam_compare::compare(&socam_compare::pair(one, other, &self.names)?, &options))
    }

    /// Simulates a model on the recording's inputs, and compares the given simulation with it.
    fn check(&self, model: &Model, inputs: &Dataset, simulation: &Dataset) -> Result<ModelCheck> {
        let name = self.model.as_ref().unwrap_or(&model.name);
        let truth = Truth::new(model, &[], &[])?;
        let replayed = Replay { truth, disturbances: Vec::new(), start: Start::Rest }.run(inputs)?;
        let own = Dataset::from_columns(name.as_str(), replayed.columns, replayed.time_s, replayed.values)?;
        let comparison = self.pair(&own, simulation)?;
        let largest = comparison.channels.iter().map(|channel| channel.error_share).fold(0.0, f64::max);
        Ok(ModelCheck { model: name.clone(), sentences: sentences(name, largest), comparison })
    }
}

/// Sentences about the difference between two simulators on the same inputs.
fn sentences(name: &str, largest: f64) -> Vec<String> {
    let apart = format!(
        "The simulator and {name} on the same inputs, from rest, are apart by {} % of a channel's standard deviation at most.",
        notation::number(100.0 * largest)
    );
    let meaning = if largest < 0.01 {
        format!("They hold the same physics: what {name} lacks is what the simulator lacks.")
    } else {
        format!(
            "They are different models, or start differently (--json lists the channels): what {name} lacks may not be what the simulator lacks."
        )
    };
    vec![apart, meaning]
}
