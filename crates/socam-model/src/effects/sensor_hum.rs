//! A sinusoidal error of a channel at a constant frequency, such as mains pick-up.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Discrepancy, Effect, EffectParameter, Family, Form, Law, LawInput,
        Linearisation, POSITIVE, Places, Prior, QuantityKind, Rule, Steady, begin_with_little, wave,
    },
    experiment, shape, usual,
};

/// reading = truth + amplitude sin(2 pi frequency time + phase), time counted from the start of the recording.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_hum",
    name: "sensor hum",
    acts_at: ActsAt::Channel,
    family: Family::Interference,
    places: Places::Channels,
    parameters: &[
        EffectParameter::new("amplitude", QuantityKind::Gain, POSITIVE),
        EffectParameter::new("frequency", QuantityKind::Frequency, POSITIVE),
        EffectParameter { name: "phase", kind: QuantityKind::Phase, default: Some((0.0, 0.0)), bounds: ANY },
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Time],
        acts: Acts::Reading,
        rule: Rule::Code(|law_inputs, p| {
            shape::wave(p[0], std::f64::consts::TAU * p[1], p[2], law_inputs[0], std::f64::consts::TAU)
        }),
        formula: "amplitude*sin(2*pi*frequency*time + phase)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["amplitude"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        rig.channel(place).lines_hz.iter().map(|hz| wave("frequency", *hz, "amplitude")).collect()
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let source = "pick-up is far below the signal that a sensor was chosen for";
        vec![
            (
                "amplitude",
                Prior::log_normal(
                    [0.01 * rig.channel(place).std, 10.0],
                    (0.0, 3.0 * rig.channel(place).std),
                    source,
                ),
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
    discrepancy: &[Discrepancy::amplitude("amplitude"), Discrepancy::frequency("frequency")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "y = y_true + A sin(2 pi f t + phi)",
    sentence: |_| "A sensor hums: mains pick-up, a ground loop, a converter's switching.",
    shows: "one frequency, whatever the motion",
    experiment: experiment::LARGE_TORQUE,
};
