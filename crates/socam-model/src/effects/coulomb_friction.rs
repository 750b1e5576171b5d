//! Dry friction of constant size that opposes the motion.

use super::{Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, shape};

/// T = -torque tanh(speed / transition_speed).
///
/// The hyperbolic tangent stands for the jump at zero speed; the transition speed is a numerical width,
/// not a property of the bearing, and must be small against the speeds of the recording. Within it the
/// law creeps where a real contact sticks.
pub(super) const EFFECT: Effect = Effect {
    id: "coulomb_friction",
    acts_at: ActsAt::Bearing,
    parameters: &[
        EffectParameter::new("torque", Kind::Torque, POSITIVE),
        EffectParameter::usual("transition_speed", Kind::Speed, (0.05, 2e-3)),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Speed],
        acts: Acts::Torque,
        answer,
        bend: |parameters| parameters[1],
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "T = -T_c sign(w)",
    sentence: "Something rubs with a drag that does not grow with speed: a seal, a brake or a preloaded bearing.",
};

fn answer(sights: &[f64], parameters: &[f64]) -> Response {
    let (sign, bend, by_width) = shape::sign(sights[0], parameters[1]);
    shape::response(-parameters[0] * sign, &[-parameters[0] * bend], &[-sign, -parameters[0] * by_width])
}
