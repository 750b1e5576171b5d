//! Friction inside a coupling: torque against twist forms a loop.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family, Form,
        Law, LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Response, Rule, Steady,
        begin_with_little,
    },
    experiment, presliding, shape, usual,
};

/// Least deflection at yield, rad (m).
const LEAST_TWIST: f64 = 1e-6;

/// A yielding spring in parallel with the elastic one: T = torque z / deflection, z' = v - |v| z / deflection with the rate of twist v
/// (P. R. Dahl, 1968; the Bouc-Wen law with exponent 1). `torque` is its limit, N m, and `deflection` the twist at which it reaches 63 %
/// of that limit, rad. |v| is rounded below `transition_speed`.
pub(super) const EFFECT: Effect = Effect {
    id: "hysteresis",
    name: "hysteresis",
    acts_at: ActsAt::Spring,
    family: Family::Elastic,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::new("deflection", QuantityKind::Angle, POSITIVE),
        EffectParameter::usual("transition_speed", QuantityKind::Speed, (0.02, 8e-4)),
    ],
    borrows: None,
    form: Form::Laws(&[
        Law {
            law_inputs: &[LawInput::TwistRate, LawInput::State],
            acts: Acts::State,
            rule: Rule::Code(creep),
            formula: "twist_rate - twist_rate*tanh(twist_rate/transition_speed)*state/deflection",
            transition: shape::no_transition,
            inactive: shape::never,
        },
        Law {
            law_inputs: &[LawInput::State],
            acts: Acts::Torque,
            rule: Rule::Code(pull),
            formula: "torque*state/deflection",
            transition: shape::no_transition,
            inactive: |parameters| parameters[0] == 0.0,
        },
    ]),
    amplitude: Amplitude::of(&["torque"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        let spring = rig.spring(place);
        // The stiffness of the model file, because the fitted stiffness of one of two springs in series may be far from it.
        let twist = if spring.stiffness > 0.0 { spring.torque / spring.stiffness } else { 0.0 };
        vec![vec![("torque", 0.0), ("deflection", (0.3 * twist).max(LEAST_TWIST))]]
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let spring = rig.spring(place);
        let twist = spring.torque / spring.stiffness;
        let source = "a loop is seen only where it closes within the twist seen: yield at a hundredth to three times of it";
        vec![
            (
                "torque",
                Prior::below(
                    spring.torque,
                    "friction inside a coupling carries less than the torque through it",
                ),
            ),
            ("deflection", Prior::log_normal([0.3 * twist, 4.0], (1e-3 * twist, 3.0 * twist), source)),
        ]
    },
    discrepancy: &[
        Discrepancy::amplitude("torque"),
        Discrepancy::share(
            "deflection",
            1.0,
            "assumed: yielding laws differ, and the deflection at yield is known to a factor of two",
        ),
    ],
    usual: usual::never,
    replaces: &[],
    equivalents: &[Equivalent { effect: "hysteresis", holds: Condition::InSeriesWithFreeStiffness }],
    steady: Steady::Unseen,
    equation: "T = T_y z/d_y, z' = v - |v| z/d_y",
    sentence: |_| "A coupling has internal friction: its torque over its twist is a loop whose width hardly grows with speed.",
    shows: "where torque is transmitted, in proportion to it",
    experiment: experiment::THROUGH_STANDSTILL,
};

fn creep(law_inputs: &[f64], p: &[f64]) -> Response {
    let (rate, derivatives, [.., by_deflection, by_width]) =
        presliding::bend(law_inputs, [p[1], p[2]], presliding::STEADY);
    shape::response(rate, &derivatives, &[0.0, by_deflection, by_width])
}

fn pull(law_inputs: &[f64], p: &[f64]) -> Response {
    let (against, by_state, by_deflection) = presliding::pull(law_inputs[0], p[0], p[1]);
    shape::response(-against, &[-by_state], &[law_inputs[0] / p[1], -by_deflection])
}
