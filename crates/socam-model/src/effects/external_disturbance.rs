//! A sinusoidal torque from outside, at a constant frequency.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Discrepancy, Effect, EffectParameter, Family, Form, Law, LawInput,
        Linearisation, POSITIVE, Places, Prior, QuantityKind, Rule, Steady, begin_with_little, wave,
    },
    experiment, shape, usual,
};

/// T = torque sin(2 pi frequency time + phase), time counted from the start of the recording.
pub(super) const EFFECT: Effect = Effect {
    id: "external_disturbance",
    name: "external disturbance",
    acts_at: ActsAt::Node,
    family: Family::Periodic,
    places: Places::Load,
    parameters: &[
        EffectParameter::new("torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::new("frequency", QuantityKind::Frequency, POSITIVE),
        EffectParameter::new("phase", QuantityKind::Phase, ANY),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Time],
        acts: Acts::Torque,
        rule: Rule::Code(|law_inputs, p| {
            shape::wave(p[0], std::f64::consts::TAU * p[1], p[2], law_inputs[0], std::f64::consts::TAU)
        }),
        formula: "torque*sin(2*pi*frequency*time + phase)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["torque"]),
    linearisation: Linearisation::Null,
    starts: |rig, _| rig.lines_hz.iter().map(|hz| wave("frequency", *hz, "torque")).collect(),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        vec![
            (
                "torque",
                Prior::below(rig.node(place).torque, "a shaker beside the bench is weaker than its drive"),
            ),
            (
                "frequency",
                Prior::flat(
                    rig.wave_hz(),
                    "a frequency is determined from five periods on, and below half the sampling rate",
                ),
            ),
            ("phase", Prior::phase()),
        ]
    },
    discrepancy: &[Discrepancy::amplitude("torque"), Discrepancy::frequency("frequency")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "T = T_0 sin(2 pi f t + phi)",
    sentence: |_| "Something shakes the load at a frequency of its own: a machine next to the bench, a pulsating pump.",
    shows: "one frequency, whatever the motion",
    experiment: experiment::LARGE_TORQUE,
};
