//! A sinusoidal torque of the drive over its angle: cogging, commutation.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family,
        Form, Law, LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Response, Rule, Steady,
        begin_with_little, wave,
    },
    experiment, shape, usual,
};

/// T = torque sin(order angle + phase), the angle counted from the start of the recording. It has no
/// influence where an input prescribes the speed of its node.
pub(super) const EFFECT: Effect = Effect {
    id: "torque_ripple",
    name: "torque ripple",
    acts_at: ActsAt::Node,
    family: Family::Periodic,
    places: Places::Driven,
    parameters: &[
        EffectParameter::new("order", QuantityKind::Ratio, POSITIVE),
        EffectParameter::new("torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::new("phase", QuantityKind::Phase, ANY),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Angle],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "torque*sin(order*angle + phase)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[1] == 0.0,
    }]),
    amplitude: Amplitude::of(&["torque"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        let seen = rig.node(place).orders;
        let low = (1..=12).map(f64::from).filter(|order| !seen.contains(order));
        let all = seen.iter().copied().chain(low).map(|order| wave("order", order, "torque"));
        all.collect()
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let source = "cogging and commutation repeat a whole number of times per turn: poles, slots, and their multiples";
        vec![
            ("order", Prior::whole_numbers(vec![1.0], 2e-3, 400.0, source)),
            (
                "torque",
                Prior::below(rig.node(place).torque, "cogging is below the torque that moves the axis"),
            ),
            ("phase", Prior::phase()),
        ]
    },
    discrepancy: &[
        Discrepancy::amplitude("torque"),
        Discrepancy::order("order"),
        Discrepancy::phase_of_turn("phase"),
    ],
    usual: usual::never,
    replaces: &[],
    equivalents: &[Equivalent {
        effect: "sensor_ripple",
        holds: Condition::Stated("of the channel that measures the drive's torque"),
    }],
    steady: Steady::Unseen,
    equation: "T = T_r sin(n theta + phi)",
    sentence: |_| "The drive's torque goes up and down as it turns: cogging, or commutation.",
    shows: "a fixed number of times per turn",
    experiment: experiment::LARGE_TORQUE,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let wave = shape::wave(p[1], p[0], p[2], law_inputs[0], 1.0);
    let [by_size, by_order, by_phase, ..] = wave.by_parameter;
    shape::response(wave.torque, &wave.derivatives, &[by_order, by_size, by_phase])
}
