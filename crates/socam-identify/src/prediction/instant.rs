//! The motion at one time.

use crate::prediction::laws::PortResponse;

/// Mode, state, inputs, forces and responses at one time.
pub(crate) struct Instant {
    /// Index of the mode, see [`HybridModes`](crate::prediction::hybrid_modes::HybridModes).
    pub(crate) mode: usize,
    pub(crate) state: Vec<f64>,
    pub(crate) inputs: Vec<f64>,
    pub(crate) forces: Vec<f64>,
    pub(crate) responses: Vec<PortResponse>,
}
