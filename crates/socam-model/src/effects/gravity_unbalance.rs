//! Weight of a load whose centre of mass is not on its axis.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family,
        Form, Law, LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Response, Rule, Steady,
        begin_with_little,
    },
    experiment, shape, usual,
};

/// T = -torque sin(angle + phase), the angle counted from the start of the recording.
pub const EFFECT: Effect = Effect {
    id: "gravity_unbalance",
    name: "gravity unbalance",
    acts_at: ActsAt::Node,
    family: Family::Periodic,
    places: Places::Load,
    parameters: &[
        EffectParameter::new("torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::new("phase", QuantityKind::Phase, ANY),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Angle],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "-torque*sin(angle + phase)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["torque"]),
    linearisation: Linearisation::Null,
    starts: |_, _| vec![vec![("torque", 0.0), ("phase", 0.0)]],
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let torque = rig.node(place).torque;
        let source = "gravity that the axis lifts is below the torque that moves it";
        vec![
            ("torque", Prior::log_normal([0.2 * torque, 4.0], (0.0, torque), source)),
            ("phase", Prior::phase()),
        ]
    },
    discrepancy: &[Discrepancy::amplitude("torque"), Discrepancy::phase_of_turn("phase")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[Equivalent {
        effect: "torque_ripple",
        holds: Condition::Stated("of order one on a shaft that is rigid below the frequencies recorded"),
    }],
    steady: Steady::Unseen,
    equation: "T = -m g e sin(theta + phi)",
    sentence: |_| "The load is heavier on one side: gravity pulls it back and forth once per turn.",
    shows: "a fixed number of times per turn",
    experiment: experiment::LARGE_TORQUE,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (sin, cos) = (law_inputs[0] + p[1]).sin_cos();
    shape::response(-p[0] * sin, &[-p[0] * cos], &[-sin, -p[0] * cos])
}
