//! Options of the diagnosis that are common to all recordings of a fleet.

use serde::{Deserialize, Serialize};
use socam_diagnose::Frozen;
use socam_job::FleetRow;

/// Options of a fleet. They are part of each row's id.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FleetOptions {
    /// p-value of the screening below which a recording gets the full diagnosis, and false-alarm rate of that diagnosis, 1.
    pub false_alarm_rate: f64,
    /// Share of a channel's standard deviation by which a finding must move a prediction to count, 1.
    pub tolerance: f64,
    /// Largest number of effects that are added.
    pub most_effects: usize,
    /// Relative tolerance of the ratio of mean speeds in the check, 1.
    pub ratio_tolerance: f64,
    /// Parameters and noise of healthy recordings; without them each recording's own are estimated, which costs more.
    pub frozen: Option<Frozen>,
}

impl Default for FleetOptions {
    fn default() -> Self {
        Self { false_alarm_rate: 0.01, tolerance: 1e-3, most_effects: 3, ratio_tolerance: 0.01, frozen: None }
    }
}

impl From<&FleetRow> for FleetOptions {
    fn from(row: &FleetRow) -> Self {
        Self { false_alarm_rate: row.false_alarm_rate, tolerance: row.tolerance, ..Self::default() }
    }
}

impl FleetOptions {
    pub(crate) fn diagnosis(&self, seed: u64) -> socam_diagnose::Options {
        socam_diagnose::Options {
            false_alarm_rate: self.false_alarm_rate,
            most_effects: self.most_effects,
            tolerance: self.tolerance,
            seed,
            ..socam_diagnose::Options::default()
        }
    }

    /// The options as text, the same for equal options.
    pub(crate) fn text(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}
