//! The first picture of a diagnosis: measured against predicted.

use serde::{Deserialize, Serialize};

/// Measured and predicted signal of one channel over a short part of one recording: the channel that the correction improves most, and the
/// part with the largest residual of the base model. All values are in the channel's SI unit; a missing value is `None`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Overlay {
    /// Name of the channel.
    pub channel: String,
    /// Its SI unit.
    pub unit: String,
    /// Name of the recording.
    pub recording: String,
    /// Whether the recording was held out: never fitted, only predicted.
    pub held_out: bool,
    /// Time of the recording, s, rising. Where samples are many, each interval has two points, the extremes of each signal in it.
    pub time_s: Vec<f64>,
    /// Measured signal.
    pub measured: Vec<Option<f64>>,
    /// Predicted by the base model, running free.
    pub before: Vec<Option<f64>>,
    /// Predicted by the model with all findings; empty where nothing was corrected.
    pub after: Vec<Option<f64>>,
    /// Residual of the base model: measured minus predicted, its own extremes.
    pub residual_before: Vec<Option<f64>>,
    /// Residual of the model with all findings; empty where nothing was corrected.
    pub residual_after: Vec<Option<f64>>,
}
