//! A part of the transmitted torque that a mesh eats.

use super::{Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, Response, Sight, shape};

/// T = -fraction |transmitted torque| tanh(speed / transition_speed), on the slow side, whose speed and torque are meant.
pub(super) const EFFECT: Effect = Effect {
    id: "mesh_loss",
    acts_at: ActsAt::Gear,
    parameters: &[
        EffectParameter::new("fraction", Kind::Ratio, (0.0, 0.95)),
        EffectParameter::usual("transition_speed", Kind::Speed, (0.05, 2e-3)),
        EffectParameter::usual("transition_torque", Kind::Torque, (0.1, 1.0)),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Speed, Sight::Torque],
        acts: Acts::Drag,
        answer,
        bend: |parameters| parameters[1],
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "T_out = N T_in (1 - f) while it is driven forward",
    sentence: "The mesh eats a fixed share of the torque it passes on: sliding between cam and rollers, or between teeth.",
};

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let (sign, bend, by_width) = shape::sign(sights[0], p[1]);
    let torque = sights[1];
    let (turn, turn_bend, by_transition) = shape::sign(torque, p[2]);
    // |torque|, smooth at zero and exact away from it.
    let size = torque * turn;
    shape::response(
        -p[0] * size * sign,
        &[-p[0] * size * bend, -p[0] * sign * (turn + torque * turn_bend)],
        &[-size * sign, -p[0] * size * by_width, -p[0] * sign * torque * by_transition],
    )
}
