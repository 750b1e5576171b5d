//! Dry friction of constant size that opposes the motion.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family, Form,
        Law, LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Response, Rule, Steady,
        all_zero, begin_with_little,
    },
    experiment, shape, usual,
};

/// T = -torque tanh(speed / transition_speed).
///
/// The hyperbolic tangent approximates the jump at zero speed. The transition speed is a numerical width,
/// not a property of the bearing, and must be small compared with the speeds of the recording. Below it the
/// law creeps where a real contact sticks.
pub const EFFECT: Effect = Effect {
    id: "coulomb_friction",
    name: "Coulomb friction",
    acts_at: ActsAt::Bearing,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::usual("transition_speed", QuantityKind::Speed, TRANSITION_SPEED),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Speed],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "-torque*tanh(speed/transition_speed)",
        transition: |parameters| parameters[1],
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["torque"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["torque"]),
    fit_starts: begin_with_little,
    priors: |rig, place| vec![("torque", Prior::below(rig.bearing(place).1.torque, FRICTION))],
    discrepancy: &[Discrepancy::amplitude("torque")],
    usual: usual::friction,
    replaces: &[],
    equivalents: &[Equivalent { effect: "constant_load", holds: Condition::OneDirection }],
    steady: Steady::Linear,
    equation: "T = -T_c sign(w)",
    sentence: |_| "Something rubs with a drag that does not grow with speed: a seal, a brake or a preloaded bearing.",
    shows: "where the motion changes its direction",
    experiment: experiment::THROUGH_STANDSTILL,
};

/// Source of the prior of a friction torque.
pub(super) const FRICTION: &str =
    "friction is below the torque that moves the axis; bearings and seals take about a tenth of it";
/// Default transition speed of friction laws, rad/s for rotation and m/s for translation.
pub const TRANSITION_SPEED: (f64, f64) = (0.05, 2e-3);

fn evaluate(law_inputs: &[f64], parameters: &[f64]) -> Response {
    let (sign, bend, by_width) = shape::sign(law_inputs[0], parameters[1]);
    shape::response(-parameters[0] * sign, &[-parameters[0] * bend], &[-sign, -parameters[0] * by_width])
}
