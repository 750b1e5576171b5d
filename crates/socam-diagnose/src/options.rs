//! Settings of a diagnosis.

use socam_identify::{ProgressMonitor, StartState};

/// What a diagnosis assumes, and when its search ends.
#[derive(Debug, Clone)]
pub struct Options {
    /// Share of benches with nothing missing for which the diagnosis may report an effect, 1.
    pub false_alarm_rate: f64,
    /// Largest number of effects that are added.
    pub most_effects: usize,
    /// Share of a channel's standard deviation by which a finding must move the prediction to count as missing physics, 1.
    pub tolerance: f64,
    /// Number of starts of the base model's fit.
    pub starts: usize,
    /// Seed of the random spread of these starts.
    pub seed: u64,
    /// State from which the simulation of each recording starts.
    pub start_state: StartState,
    /// Effects and places that are fitted together with the corrected model and in the place of each finding, to tell why they are none.
    pub why: Vec<(String, String)>,
    /// Receives progress and can cancel the diagnosis.
    pub progress: ProgressMonitor,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            false_alarm_rate: 0.01,
            most_effects: 3,
            tolerance: 1e-3,
            starts: 6,
            seed: 1,
            start_state: StartState::Free,
            why: Vec::new(),
            progress: ProgressMonitor::default(),
        }
    }
}
