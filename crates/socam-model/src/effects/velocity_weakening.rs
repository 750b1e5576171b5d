//! Friction that falls with speed, on a machine that turns in one direction.

use super::{
    coulomb_friction::FRICTION,
    definition::{
        ANY, Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family,
        Form, Law, LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Response, Rule, Steady,
        begin_with_little,
    },
    experiment, shape, usual,
};

/// T = -torque exp(-(speed / fall_speed)²): drag that decreases from `torque` at standstill to 0 well above `fall_speed`. The drag does not
/// change its sign with the speed, so that it is continuous at standstill; it is valid for one direction of motion only. The drag that
/// remains at high speed belongs to `constant_load` or `coulomb_friction`.
pub(super) const EFFECT: Effect = Effect {
    id: "velocity_weakening",
    name: "velocity-weakening friction",
    acts_at: ActsAt::Bearing,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("torque", QuantityKind::Torque, ANY),
        EffectParameter::new("fall_speed", QuantityKind::Speed, POSITIVE),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Speed],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "-torque*exp(-(speed/fall_speed)^2)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["torque"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        let node = rig.bearing(place).1;
        // The law is not valid where the motion reverses.
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
    usual: usual::never,
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
    shows: "slow motion, compared with fast motion in the same direction",
    experiment: experiment::THROUGH_STANDSTILL,
};

/// Largest `reverse_share` of a machine that counts as turning in one direction.
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
