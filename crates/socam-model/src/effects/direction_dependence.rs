//! A bearing whose friction and damping differ between forward and backward motion.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family,
        Form, Law, LawInput, Linearisation, Places, Prior, QuantityKind, Response, Rule, Steady, all_zero,
        begin_with_little,
    },
    experiment, shape, usual,
};

/// T = -(torque_difference tanh²(speed / transition_speed) + damping_difference |speed|) / 2: differences are forward minus
/// backward. The mean of both directions belongs to the friction and damping of the bearing.
///
/// Away from standstill `torque_difference` acts as a constant torque: only recordings with standstill separate it from `constant_load`.
pub(super) const EFFECT: Effect = Effect {
    id: "direction_dependence",
    name: "direction dependence",
    acts_at: ActsAt::Bearing,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("torque_difference", QuantityKind::Torque, ANY),
        EffectParameter::new("damping_difference", QuantityKind::Damping, ANY),
        EffectParameter::usual("transition_speed", QuantityKind::Speed, (0.05, 2e-3)),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Speed],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "-0.5*(torque_difference*tanh(speed/transition_speed)^2 + \
                  damping_difference*speed*tanh(speed/transition_speed))",
        transition: |parameters| parameters[2],
        inactive: |parameters| parameters[0] == 0.0 && parameters[1] == 0.0,
    }]),
    amplitude: Amplitude::of(&["torque_difference", "damping_difference"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["torque_difference", "damping_difference"]),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let (bearing, node) = rig.bearing(place);
        let damping = bearing.damping + node.torque / node.speed;
        vec![
            (
                "torque_difference",
                Prior::within(
                    2.0 * node.torque,
                    "friction of either direction is below the torque that moves the axis",
                ),
            ),
            (
                "damping_difference",
                Prior::within(
                    2.0 * damping,
                    "drag in either direction is not negative: half of the difference is below the bearing's own damping and what friction adds at the \
                     largest speed",
                ),
            ),
        ]
    },
    discrepancy: &[Discrepancy::amplitude("torque_difference"), Discrepancy::amplitude("damping_difference")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[Equivalent { effect: "constant_load", holds: Condition::OneDirection }],
    steady: Steady::Unseen,
    equation: "T = -(dT + dc |w|)/2, forward and backward",
    sentence: |_| "It drags more one way than the other: a seal lip, a worm, a preloaded screw.",
    shows: "where the motion changes its direction",
    experiment: experiment::THROUGH_STANDSTILL,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let speed = law_inputs[0];
    let (sign, bend, by_width) = shape::sign(speed, p[2]);
    // |speed|, rounded at zero over the transition speed.
    let size = speed * sign;
    shape::response(
        -0.5 * (p[0] * sign * sign + p[1] * size),
        &[-0.5 * (2.0 * p[0] * sign * bend + p[1] * (sign + speed * bend))],
        &[-0.5 * sign * sign, -0.5 * size, -0.5 * (2.0 * p[0] * sign + p[1] * speed) * by_width],
    )
}
