//! Friction that falls with speed, on a machine that turns one way.

use super::{
    coulomb_friction::FRICTION,
    definition::{
        ANY, Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Form,
        Kind, Law, LawInput, Linearisation, POSITIVE, Places, Prior, Response, Steady, begin_with_little,
    },
    experiment, shape,
};

/// T = -torque exp(-(speed / fall_speed)²): at standstill `torque` more than far above the fall speed. Its sign is that of the torque and
/// not of the motion, so that nothing jumps where the machine comes to rest; what is left at high speed is a constant load's or Coulomb
/// friction's.
pub(super) const EFFECT: Effect = Effect {
    id: "velocity_weakening",
    name: "velocity-weakening friction",
    acts_at: ActsAt::Bearing,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("torque", Kind::Torque, ANY),
        EffectParameter::new("fall_speed", Kind::Speed, POSITIVE),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Speed],
        acts: Acts::Torque,
        evaluate,
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["torque"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        let node = rig.bearing(place).1;
        // Where the motion turns round, friction has a sign.
        let turns_one_way = node.speed > 0.0 && node.reverse_share < ONE_WAY;
        let shares: &[f64] = if turns_one_way { &[0.05, 0.2, 0.6] } else { &[] };
        shares.iter().map(|share| vec![("torque", 0.0), ("fall_speed", share * node.speed)]).collect()
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let node = rig.bearing(place).1;
        let source = "the fall of friction is seen only where it lies between standstill and a few times the largest speed";
        vec![
            ("torque", Prior::within(node.torque, FRICTION)),
            (
                "fall_speed",
                Prior::log_normal([0.2 * node.speed, 3.0], (1e-3 * node.speed, 5.0 * node.speed), source),
            ),
        ]
    },
    discrepancy: &[Discrepancy::amplitude("torque")],
    replaces: &[],
    equivalents: &[Equivalent { effect: "stribeck_friction", holds: Condition::OneDirection }],
    steady: Steady::Unseen,
    equation: "T = -T_0 exp(-(w/w_0)^2)",
    sentence: |fitted| {
        if fitted.get("torque") < 0.0 {
            "The drag grows with speed and then levels off, on a machine that turns one way: a seal or bearing that heats up or floats."
        } else {
            "The drag falls as the machine turns faster, on a machine that turns one way: a bit, a brake or a dry bearing that chatters."
        }
    },
    shows: "slow motion, against fast motion in the same direction",
    experiment: experiment::THROUGH_STANDSTILL,
};

/// Largest speed backward over the largest forward (or the other way round) of a machine that turns one way.
const ONE_WAY: f64 = 0.05;

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let ratio = law_inputs[0] / p[1];
    let rest = (-ratio * ratio).exp();
    shape::response(
        -p[0] * rest,
        &[2.0 * p[0] * rest * ratio / p[1]],
        &[-rest, -2.0 * p[0] * rest * ratio * ratio / p[1]],
    )
}
