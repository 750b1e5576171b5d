//! Events of an integration: accepted steps, jumps of held inputs, and switches between the modes of a gear with play.

use crate::prediction::{
    inactive_laws::{InactiveInputs, InactiveLaws},
    instant::Instant,
    laws::{PortLaw, PortResponse},
    step_level::StepLevel,
};

/// A report of the integrator during the integration.
pub(crate) enum Event<'w> {
    /// A step was accepted; the state has not moved yet.
    Step(&'w AcceptedStep<'w>),
    /// Teeth met or parted within the last step; state and forces are those after the switch.
    Switch(&'w SwitchingEvent),
    /// A held input jumped, and with it the input of a port.
    Jump(&'w Instant),
}

/// An accepted step.
pub(crate) struct AcceptedStep<'w> {
    pub(crate) level: &'w StepLevel,
    /// States, inputs and forces of the step, see [`step_level`](crate::prediction::step_level).
    pub(crate) xi: &'w [f64],
    /// Responses of all ports in the middle of the step, then at its end.
    pub(crate) responses: &'w [PortResponse],
    pub(crate) laws: &'w [PortLaw],
    pub(crate) inactive_laws: &'w InactiveLaws,
    /// The step's map to the inputs of the inactive laws.
    pub(crate) inactive_inputs: &'w InactiveInputs,
}

/// A switch from one mode to the next. The boundary is detected slightly late, so the state is moved back along the motion of the
/// mode before, and forward along the motion of the mode after.
pub(crate) struct SwitchingEvent {
    /// Instant in the mode before, when the switch was detected.
    pub(crate) before: Instant,
    /// Instant in the mode after, at the same state.
    pub(crate) beyond: Instant,
    /// Instant in the mode after, at the corrected state.
    pub(crate) after: Instant,
    /// Time since the boundary was crossed, s.
    pub(crate) late_s: f64,
    /// Rate of the mesh's twist, rad/s.
    pub(crate) rate: f64,
    /// Rates of the states in the mode before, less those in the mode after.
    pub(crate) jump: Vec<f64>,
}
