//! A constant offset of a channel.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Discrepancy, Effect, EffectParameter, Family, Form, Law, Linearisation,
        Places, Prior, QuantityKind, Rule, Steady, all_zero, begin_with_little,
    },
    experiment, shape, usual,
};

/// reading = truth + offset.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_offset",
    name: "sensor offset",
    acts_at: ActsAt::Channel,
    family: Family::Reading,
    places: Places::Channels,
    parameters: &[EffectParameter::new("offset", QuantityKind::Gain, ANY)],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[],
        acts: Acts::Reading,
        rule: Rule::Code(|_, parameters| shape::response(parameters[0], &[], &[1.0])),
        formula: "offset",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["offset"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["offset"]),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        vec![(
            "offset",
            Prior::within(
                rig.channel(place).largest,
                "an offset larger than the readings is visible without a model",
            ),
        )]
    },
    discrepancy: &[Discrepancy::amplitude("offset")],
    usual: usual::offset,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Linear,
    equation: "y = y_true + o",
    sentence: |_| "A sensor does not read zero at zero: its zero has drifted, or was never set.",
    shows: "everywhere",
    experiment: experiment::LARGE_TORQUE,
};
