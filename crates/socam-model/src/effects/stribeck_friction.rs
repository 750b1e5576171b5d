//! Dry friction that is larger at standstill than in motion.

use super::{
    coulomb_friction::FRICTION,
    definition::{
        Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family, Form,
        Law, LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Replaces, Response, Rule,
        Steady, begin_with_little,
    },
    experiment, shape, usual,
};

/// T = -(torque + (static_torque - torque) exp(-(speed / stribeck_speed)²)) tanh(speed / transition_speed).
pub(super) const EFFECT: Effect = Effect {
    id: "stribeck_friction",
    name: "Stribeck friction",
    acts_at: ActsAt::Bearing,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::new("static_torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::new("stribeck_speed", QuantityKind::Speed, POSITIVE),
        EffectParameter::usual("transition_speed", QuantityKind::Speed, (0.05, 2e-3)),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Speed],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "-(torque + (static_torque - \
                  torque)*exp(-(speed/stribeck_speed)^2))*tanh(speed/transition_speed)",
        transition: |parameters| parameters[3],
        inactive: |parameters| parameters[0] == 0.0 && parameters[1] == 0.0,
    }]),
    amplitude: Amplitude::of(&["torque", "static_torque"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        let speed = rig.bearing(place).1.speed;
        let start = |share: f64| {
            vec![
                ("torque", 0.0),
                ("static_torque", 0.0),
                ("stribeck_speed", (share * speed).max(least_speed(speed))),
            ]
        };
        [0.02, 0.06, 0.2].map(start).to_vec()
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let node = rig.bearing(place).1;
        vec![
            ("torque", Prior::below(node.torque, FRICTION)),
            ("static_torque", Prior::below(node.torque, FRICTION)),
            (
                "stribeck_speed",
                Prior::log_normal(
                    [0.05 * node.speed, 5.0],
                    (least_speed(node.speed), node.speed),
                    "the fall of friction is seen only where it lies between standstill and the largest speed",
                ),
            ),
        ]
    },
    discrepancy: &[Discrepancy::amplitude("torque"), Discrepancy::amplitude("static_torque")],
    usual: usual::never,
    replaces: &[Replaces {
        law: "coulomb_friction",
        starts: |_, fitted| {
            let torque = fitted.get("torque");
            vec![vec![("torque", torque), ("static_torque", 1.5 * torque)]]
        },
    }],
    equivalents: &[Equivalent {
        effect: "coulomb_friction",
        holds: Condition::Stated(
            "unless the recording has slow motion, in which alone friction rises towards standstill",
        ),
    }],
    steady: Steady::Unseen,
    equation: "T = -(T_c + (T_s - T_c) exp(-(w/w_s)^2)) sign(w)",
    sentence: |fitted| {
        if fitted.get("static_torque") < fitted.get("torque") {
            "Something rubs, less at standstill than in motion: a lubricated bearing or seal whose drag rises with speed and levels off."
        } else {
            "Something rubs, and sticks harder than it slides: a dry or starved bearing, a seal, a brake pad."
        }
    },
    shows: "slow motion in either direction",
    experiment: experiment::THROUGH_STANDSTILL,
};

/// Least Stribeck speed, rad/s (m/s), and as a share of the largest speed of a slower bearing.
const LEAST_SPEED: f64 = 1e-3;
const LEAST_SHARE: f64 = 5e-3;

fn least_speed(largest: f64) -> f64 {
    if largest > 0.0 { LEAST_SPEED.min(LEAST_SHARE * largest) } else { LEAST_SPEED }
}

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (sign, bend, by_width) = shape::sign(law_inputs[0], p[3]);
    let ratio = law_inputs[0] / p[2];
    let rest = (-ratio * ratio).exp();
    let size = p[0] + (p[1] - p[0]) * rest;
    let size_by_speed = -2.0 * (p[1] - p[0]) * rest * ratio / p[2];
    shape::response(
        -size * sign,
        &[-size * bend - size_by_speed * sign],
        &[-(1.0 - rest) * sign, -rest * sign, size_by_speed * ratio * sign, -size * by_width],
    )
}
