//! Dry friction of constant size that opposes the motion.

use super::{ActsAt, Effect, EffectParameter, Kind, Response};

/// T = -torque tanh(speed / transition_speed).
///
/// The hyperbolic tangent stands for the jump at zero speed; the transition speed is a numerical width,
/// not a property of the bearing, and must be small against the speeds of the recording. Within it the
/// law creeps where a real contact sticks.
pub(super) const EFFECT: Effect = Effect {
    id: "coulomb_friction",
    acts_at: ActsAt::Bearing,
    parameters: &[
        EffectParameter { name: "torque", kind: Kind::Torque, default: None },
        EffectParameter { name: "transition_speed", kind: Kind::Speed, default: Some((0.05, 2e-3)) },
    ],
    equation: "T = -T_c sign(w)",
    sentence: "Something rubs with a drag that does not grow with speed: a seal, a brake or a preloaded bearing.",
    law,
    transition_speed: |parameters| parameters[1],
};

fn law(speed: f64, parameters: &[f64]) -> Response {
    let (torque, width) = (parameters[0], parameters[1]);
    let tanh = (speed / width).tanh();
    let bend = (1.0 - tanh * tanh) / width;
    Response {
        torque: -torque * tanh,
        slope_speed: -torque * bend,
        slope_parameters: [-tanh, torque * bend * speed / width, 0.0, 0.0],
    }
}
