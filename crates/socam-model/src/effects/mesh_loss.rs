//! A part of the transmitted torque that a mesh eats.

use super::{
    Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Form, Kind, Law,
    Linearisation, Places, Prior, Response, Sight, Steady, all_zero, begin_with_little, experiment, shape,
};

/// T = -fraction |transmitted torque| tanh(speed / transition_speed), on the slow side, whose speed and torque are meant.
pub(super) const EFFECT: Effect = Effect {
    id: "mesh_loss",
    name: "mesh loss",
    acts_at: ActsAt::Gear,
    places: Places::Every,
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
    amplitude: Amplitude::of(&["fraction"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["fraction"]),
    fit_starts: begin_with_little,
    priors: |_, _| {
        let source = "losses of gears: 1 to 2 % of a spur stage, 10 to 30 % of a cheap gearbox, 50 % and more of a worm";
        vec![("fraction", Prior::log_normal([0.05, 4.0], (0.0, 0.95), source))]
    },
    discrepancy: &[Discrepancy::amplitude("fraction")],
    replaces: &[],
    equivalents: &[Equivalent {
        effect: "sensor_gain",
        holds: Condition::Stated(
            "of a torque sensor behind the gear, while the drive always drives and never brakes",
        ),
    }],
    steady: Steady::Linear,
    equation: "T_out = N T_in (1 - f) while it is driven forward",
    sentence: |_| "The mesh eats a fixed share of the torque it passes on: sliding between cam and rollers, or between teeth.",
    shows: "where torque is transmitted, in proportion to it",
    experiment: experiment::DRIVEN_BY_LOAD,
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
