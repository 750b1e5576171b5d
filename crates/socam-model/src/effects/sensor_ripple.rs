//! A sinusoidal error of a sensor over the angle of its shaft.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family,
        Form, Law, LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Rule, Steady,
        begin_with_little, wave,
    },
    experiment, shape, usual,
};

/// reading = truth + amplitude sin(order angle + phase), the angle counted from the start of the recording.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_ripple",
    name: "sensor ripple",
    acts_at: ActsAt::Channel,
    family: Family::Interference,
    places: Places::Channels,
    parameters: &[
        EffectParameter::new("amplitude", QuantityKind::Gain, POSITIVE),
        EffectParameter::new("order", QuantityKind::Ratio, POSITIVE),
        EffectParameter { name: "phase", kind: QuantityKind::Phase, default: Some((0.0, 0.0)), bounds: ANY },
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Angle],
        acts: Acts::Reading,
        rule: Rule::Code(|law_inputs, p| shape::wave(p[0], p[1], p[2], law_inputs[0], 1.0)),
        formula: "amplitude*sin(order*angle + phase)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["amplitude"]),
    linearisation: Linearisation::Null,
    starts: |_, _| (1..=12).map(|order| wave("order", f64::from(order), "amplitude")).collect(),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let source = "commutators, magnets and bent couplings repeat a whole number of times per turn";
        vec![
            (
                "amplitude",
                Prior::log_normal(
                    [0.01 * rig.channel(place).std, 10.0],
                    (0.0, 3.0 * rig.channel(place).std),
                    RIPPLE,
                ),
            ),
            ("order", Prior::whole_numbers(vec![1.0], 2e-3, 400.0, source)),
            ("phase", Prior::phase()),
        ]
    },
    discrepancy: &[
        Discrepancy::amplitude("amplitude"),
        Discrepancy::order("order"),
        Discrepancy::phase_of_turn("phase"),
    ],
    usual: usual::never,
    replaces: &[],
    equivalents: &[Equivalent {
        effect: "torque_ripple",
        holds: Condition::Stated("of the node that the measured torque drives"),
    }],
    steady: Steady::Unseen,
    equation: "y = y_true + A sin(n theta + phi)",
    sentence: |_| "A sensor's error repeats as its shaft turns: a tachometer's commutator, a bent coupling, a magnet off centre.",
    shows: "a fixed number of times per turn",
    experiment: experiment::LARGE_TORQUE,
};

/// Source of the prior of the amplitude.
const RIPPLE: &str = "ripple is far below the signal that a sensor was chosen for";
