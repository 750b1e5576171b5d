//! A bench watched against its model.

use serde::{Deserialize, Serialize};
use socam_model::Model;
use socam_monitoring::{Baseline, Event, Watched};
use socam_recording::Dataset;

use crate::error::Result;
use crate::model::ModelSettings;
use crate::notation::seconds;
use crate::options::Settings;

/// How a bench is watched
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Watching {
    /// Mean number of alarms per hour of a healthy bench, over all channels
    #[arg(long, value_name = "RATE", default_value_t = 0.5, allow_hyphen_values = true)]
    pub false_alarms_per_hour: f64,
    /// Longest stretch after a change from which its cause is named, as in 10s [default: 10s]
    #[arg(long = "window", value_name = "TIME", value_parser = seconds)]
    pub window_s: Option<f64>,
    /// Length of the blocks that are compared with the model, as in 500ms [default: 500ms]
    #[arg(long = "block", value_name = "TIME", value_parser = seconds)]
    pub block_s: Option<f64>,
    /// Length of the beginning that is the baseline where none is given, as in 30s [default: 30s]
    #[arg(long = "learn", value_name = "TIME", value_parser = seconds)]
    pub learn_s: Option<f64>,
}

impl Watching {
    /// Whether any option but the rate was given.
    #[must_use]
    pub fn is_set(&self) -> bool {
        self.window_s.is_some() || self.block_s.is_some() || self.learn_s.is_some()
    }

    /// As the library takes them.
    #[must_use]
    pub fn settings(&self) -> socam_monitoring::Settings {
        let usual = socam_monitoring::Settings::default();
        socam_monitoring::Settings {
            false_alarms_per_hour: self.false_alarms_per_hour,
            window_s: self.window_s.unwrap_or(usual.window_s),
            block_s: self.block_s.unwrap_or(usual.block_s),
            learn_s: self.learn_s.unwrap_or(usual.learn_s),
        }
    }

    /// The baseline of healthy recordings on the grid [`Even`](crate::Grid::Even); `None` of none.
    ///
    /// # Errors
    /// When they are too short, or the model cannot be evaluated on them.
    pub fn baseline(&self, model: &Model, healthy: &[Dataset]) -> Result<Option<Baseline>> {
        if healthy.is_empty() {
            return Ok(None);
        }
        Ok(Some(Baseline::of(model, healthy, &self.settings())?))
    }
}

/// Settings of a watch over recordings
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Watch {
    /// The model.
    #[command(flatten)]
    #[serde(flatten)]
    pub model: ModelSettings,
    /// How it is watched.
    #[command(flatten)]
    #[serde(flatten)]
    pub watching: Watching,
}

impl Settings for Watch {
    const COMMAND: &'static [&'static str] = &["watch"];
}

impl Watch {
    /// Watches a recording on the grid [`Even`](crate::Grid::Even) from its beginning to its end; the events are in order of time.
    ///
    /// # Errors
    /// When the recording cannot be read, or the model cannot be evaluated on it.
    pub fn run(
        &self,
        model: &Model,
        baseline: Option<Baseline>,
        data: &Dataset,
    ) -> Result<(Watched, Vec<Event>)> {
        let monitor =
            socam_monitoring::Monitor::new(model, data.channels(), baseline, self.watching.settings())?;
        Ok(Watched::of(monitor, data)?)
    }
}
