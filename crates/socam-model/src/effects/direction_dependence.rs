//! A bearing that drags differently forward and backward.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, Response, Sight, shape};

/// T = -(torque_difference tanh²(speed / transition_speed) + damping_difference |speed|) / 2: differences are forward minus
/// backward, and the mean of both directions is left to friction and damping.
///
/// While a shaft turns, a torque difference is a constant torque: only at standstill does it differ from one.
pub(super) const EFFECT: Effect = Effect {
    id: "direction_dependence",
    acts_at: ActsAt::Bearing,
    parameters: &[
        EffectParameter::new("torque_difference", Kind::Torque, ANY),
        EffectParameter::new("damping_difference", Kind::Damping, ANY),
        EffectParameter::usual("transition_speed", Kind::Speed, (0.05, 2e-3)),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Speed],
        acts: Acts::Torque,
        answer,
        bend: |parameters| parameters[2],
        silent: |parameters| parameters[0] == 0.0 && parameters[1] == 0.0,
    }]),
    equation: "T = -(dT + dc |w|)/2, forward and backward",
    sentence: "It drags more one way than the other: a seal lip, a worm, a preloaded screw.",
};

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let speed = sights[0];
    let (sign, bend, by_width) = shape::sign(speed, p[2]);
    // |speed|, smooth at zero on the same scale.
    let size = speed * sign;
    shape::response(
        -0.5 * (p[0] * sign * sign + p[1] * size),
        &[-0.5 * (2.0 * p[0] * sign * bend + p[1] * (sign + speed * bend))],
        &[-0.5 * sign * sign, -0.5 * size, -0.5 * (2.0 * p[0] * sign + p[1] * speed) * by_width],
    )
}
