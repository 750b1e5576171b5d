//! Dry friction that is larger at standstill than in motion.

use super::{Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, shape};

/// T = -(torque + (static_torque - torque) exp(-(speed / stribeck_speed)²)) tanh(speed / transition_speed).
pub(super) const EFFECT: Effect = Effect {
    id: "stribeck_friction",
    acts_at: ActsAt::Bearing,
    parameters: &[
        EffectParameter::new("torque", Kind::Torque, POSITIVE),
        EffectParameter::new("static_torque", Kind::Torque, POSITIVE),
        EffectParameter::new("stribeck_speed", Kind::Speed, POSITIVE),
        EffectParameter::usual("transition_speed", Kind::Speed, (0.05, 2e-3)),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Speed],
        acts: Acts::Torque,
        answer,
        bend: |parameters| parameters[3],
        silent: |parameters| parameters[0] == 0.0 && parameters[1] == 0.0,
    }]),
    equation: "T = -(T_c + (T_s - T_c) exp(-(w/w_s)^2)) sign(w)",
    sentence: "Something rubs, and sticks harder than it slides: a dry or starved bearing, a seal, a brake pad.",
};

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let (sign, bend, by_width) = shape::sign(sights[0], p[3]);
    let ratio = sights[0] / p[2];
    let rest = (-ratio * ratio).exp();
    let size = p[0] + (p[1] - p[0]) * rest;
    let size_by_speed = -2.0 * (p[1] - p[0]) * rest * ratio / p[2];
    shape::response(
        -size * sign,
        &[-size * bend - size_by_speed * sign],
        &[-(1.0 - rest) * sign, -rest * sign, size_by_speed * ratio * sign, -size * by_width],
    )
}
