//! Whether recordings can carry a fit.

use serde::{Deserialize, Serialize};
use socam_model::Model;
use socam_recording::check::{self, CheckOptions};
use socam_recording::{Channel, Dataset};

use crate::error::{JobError, Result};
use crate::model::{MODEL_HELP, load_model};
use crate::notation;
use crate::options::Settings;

/// Settings of a check
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Check {
    /// Name of an embedded model, or path of a model file.
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = MODEL_HELP)]
    pub model: String,
    /// Check all channels without a model; this channel is the input
    #[arg(long, value_name = "CHANNEL", conflicts_with = "model")]
    pub input: Option<String>,
    /// Tolerance of the mean ratio of two speeds against that of the gears, percent
    #[arg(long, value_name = "PERCENT", default_value = "1.0", value_parser = notation::percent::read, allow_hyphen_values = true)]
    #[serde(with = "notation::percent")]
    pub ratio_tolerance: f64,
}

impl Settings for Check {
    const COMMAND: &'static [&'static str] = &["check"];

    fn validate(&self) -> Result<()> {
        let percent = 100.0 * self.ratio_tolerance;
        if !(0.0..=100.0).contains(&percent) {
            let problem = format!(" is {percent} %; expected 0 to 100");
            return Err(JobError::value("ratio_tolerance", "--ratio-tolerance", problem));
        }
        Ok(())
    }
}

impl Check {
    /// The model whose channels are checked; `None` where an input is named instead.
    ///
    /// # Errors
    /// When there is no such model, or its file has a mistake.
    pub fn load(&self) -> Result<Option<Model>> {
        self.input.is_none().then(|| load_model(&self.model)).transpose()
    }

    /// Checks one recording, on the grid [`View`](crate::Grid::View): the channels of the model, or all of them.
    ///
    /// # Errors
    /// When it cannot be read, lacks the input, or has none of the model's channels.
    pub fn run(&self, model: Option<&Model>, data: &Dataset) -> Result<check::Check> {
        let options = match model {
            Some(model) => {
                require_common_ground(data, model)?;
                socam_requirements::of_model(model, self.ratio_tolerance)
            }
            None => CheckOptions { input: self.input.clone(), ..CheckOptions::default() },
        };
        Ok(check::check(data, &options)?)
    }
}

/// A recording with none of the model's channels is one of another bench.
fn require_common_ground(data: &Dataset, model: &Model) -> Result<()> {
    if model.channels.iter().any(|channel| data.channel_index(&channel.column).is_ok()) {
        return Ok(());
    }
    let read: Vec<&str> = model.channels.iter().map(|channel| channel.column.as_str()).collect();
    let held: Vec<String> = data.channels().iter().map(Channel::column_name).collect();
    Err(JobError::OtherModel {
        problem: format!(
            "`{}` has none of the channels that the model {} reads ({}); it has {}; choose its model, or name its input",
            data.name(),
            model.name,
            read.join(", "),
            held.join(", ")
        ),
    })
}
