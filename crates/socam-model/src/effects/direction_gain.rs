//! A gain that differs between positive and negative values.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Discrepancy, Effect, EffectParameter, Family, Form, Law, LawInput,
        Linearisation, Places, Prior, QuantityKind, Response, Rule, Steady, all_zero, begin_with_little,
    },
    experiment, shape, usual,
};

/// reading = truth + difference |truth| / 2: `difference` is the gain for positive values minus that for negative
/// values. Their mean belongs to the gain of the channel.
pub(super) const EFFECT: Effect = Effect {
    id: "direction_gain",
    name: "direction-dependent gain",
    acts_at: ActsAt::Channel,
    family: Family::Reading,
    places: Places::Channels,
    parameters: &[EffectParameter::new("difference", QuantityKind::Ratio, (-1.9, 1.9))],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Reading],
        acts: Acts::Reading,
        rule: Rule::Code(evaluate),
        formula: "0.5*difference*abs(reading)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["difference"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["difference"]),
    fit_starts: begin_with_little,
    priors: |_, _| {
        let source = "half bridges and torque constants differ by some per cent between directions; neither gain changes its sign";
        vec![("difference", Prior::normal([0.0, 0.1], (-1.9, 1.9), source))]
    },
    discrepancy: &[Discrepancy::amplitude("difference")],
    usual: usual::directions,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "y = y_true (1 + dg sign(y_true)/2)",
    sentence: |fitted| {
        if fitted.get("difference") > 0.0 {
            "A sensor or drive has a larger gain for positive values than for negative ones: its two directions are not calibrated alike."
        } else if fitted.get("difference") < 0.0 {
            "A sensor or drive has a smaller gain for positive values than for negative ones: its two directions are not calibrated alike."
        } else {
            "A sensor or drive has different gains for positive and negative values."
        }
    },
    shows: "in one direction compared with the other",
    experiment: experiment::THROUGH_STANDSTILL,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (size, sign) = (law_inputs[0].abs(), law_inputs[0].signum());
    shape::response(0.5 * p[0] * size, &[0.5 * p[0] * sign], &[0.5 * size])
}
