//! A sensor that loses the sign of the speed, as a pulse counter does.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Discrepancy, Effect, EffectParameter, Family, Form, Law, LawInput,
        Linearisation, Places, Prior, QuantityKind, Response, Rule, Steady, all_zero,
    },
    experiment, shape, usual,
};

/// reading = truth + share (|truth| - truth): with a share of one the reading is |truth|.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_fold",
    name: "sensor fold",
    acts_at: ActsAt::Channel,
    family: Family::Reading,
    places: Places::Sensors,
    parameters: &[EffectParameter::new("share", QuantityKind::Ratio, (0.0, 1.0))],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Reading],
        acts: Acts::Reading,
        rule: Rule::Code(evaluate),
        formula: "share*max(-2*reading, 0)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["share"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["share"]),
    fit_starts: |_, _, little, _| vec![little.clone(), vec![("share", 1.0)]],
    priors: |_, _| {
        let source =
            "a counter of pulses has no sign at all; one that misses some of them on the way back is rare";
        vec![("share", Prior::normal([1.0, 0.05], (0.0, 1.0), source))]
    },
    discrepancy: &[Discrepancy::amplitude("share")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "y = |y_true|",
    sentence: |_| "A sensor reads the same sign whichever way it turns: it counts pulses and does not know the direction.",
    shows: "where the motion changes its direction",
    experiment: experiment::THROUGH_STANDSTILL,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let beyond = (-2.0 * law_inputs[0]).max(0.0);
    let derivative = if law_inputs[0] < 0.0 { -2.0 } else { 0.0 };
    shape::response(p[0] * beyond, &[p[0] * derivative], &[beyond])
}
