//! Settings of a monitor.

use crate::MonitorError;

/// Settings of a monitor.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Mean number of alarms per hour of a healthy bench, over all channels, 1/h.
    pub false_alarms_per_hour: f64,
    /// Length of the window that is shown, s; also the longest time after a change that is used to name its cause.
    pub window_s: f64,
    /// Length of a block, s: the start state of the model is fitted to each block, and each gives one value of every statistic. It should
    /// hold several periods of the slowest resonance.
    pub block_s: f64,
    /// Length of the beginning of the recording that serves as the baseline where none is given, s.
    pub learn_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { false_alarms_per_hour: 0.5, window_s: 10.0, block_s: 0.5, learn_s: 30.0 }
    }
}

impl Settings {
    /// Refuses settings that are not positive, or a window that holds no block.
    pub(crate) fn check(&self) -> Result<(), MonitorError> {
        let all = [
            ("the false alarms per hour", self.false_alarms_per_hour),
            ("the window", self.window_s),
            ("the length of a block", self.block_s),
            ("the length of the baseline", self.learn_s),
        ];
        if let Some((name, value)) = all.iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            return Err(MonitorError::Setting(format!(
                "{name} cannot be {value}: it must be greater than 0"
            )));
        }
        if self.window_s < 2.0 * self.block_s {
            return Err(MonitorError::Setting(format!(
                "a window of {} s is too short for blocks of {} s: it must hold two at least",
                self.window_s, self.block_s
            )));
        }
        Ok(())
    }
}
