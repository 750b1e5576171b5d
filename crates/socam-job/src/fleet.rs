//! Settings with which each recording of a fleet is diagnosed.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::model::MODEL_HELP;
use crate::options::Settings;
use crate::rules::check_false_alarm_rate;

/// Settings of the rows of a fleet's table
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct FleetRow {
    /// Name of an embedded model, or path of a model file.
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = MODEL_HELP)]
    pub model: String,
    /// p-value below which a recording gets the full diagnosis
    #[arg(long, value_name = "P", default_value_t = 0.01)]
    pub false_alarm_rate: f64,
    /// Materiality, a fraction of a channel's standard deviation
    #[arg(long, value_name = "SHARE", default_value_t = 0.001)]
    pub tolerance: f64,
    /// Seed of the random start values
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

impl Settings for FleetRow {
    const COMMAND: &'static [&'static str] = &["fleet"];

    fn validate(&self) -> Result<()> {
        check_false_alarm_rate(self.false_alarm_rate)
    }
}
