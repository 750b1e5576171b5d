//! A channel whose readings are limited to a range.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Coordinate, Discrepancy, Effect, EffectParameter, Family, Form, Law,
        LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Response, Rule, Steady,
        begin_with_little,
    },
    experiment, shape, usual,
};

/// reading = truth, limited to -limit .. limit.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_saturation",
    name: "sensor saturation",
    acts_at: ActsAt::Channel,
    family: Family::Reading,
    places: Places::Sensors,
    parameters: &[EffectParameter::new("limit", QuantityKind::Gain, POSITIVE)],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Reading],
        acts: Acts::Reading,
        rule: Rule::Code(evaluate),
        formula: "0.5*(sqrt((reading + limit)^2 + 1e-12*limit^2) - sqrt((reading - limit)^2 + 1e-12*limit^2)) - \
                  reading",
        transition: shape::no_transition,
        inactive: shape::never,
    }]),
    amplitude: Amplitude { parameters: &["limit"], null: f64::INFINITY, coordinate: Coordinate::Value },
    linearisation: Linearisation::NonNull,
    starts: |rig, place| rig.channel(place).limit.map(|limit| vec![("limit", limit)]).into_iter().collect(),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let largest = rig.channel(place).largest;
        let source = "a range that is too small ends at the largest readings";
        vec![("limit", Prior::log_normal([largest, 1.2], (0.3 * largest, 1.5 * largest), source))]
    },
    discrepancy: &[Discrepancy::amplitude("limit")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "|y| <= y_max",
    sentence: |_| "A sensor's peaks are cut off: its range, or its amplifier's, is too small.",
    shows: "everywhere",
    experiment: experiment::LARGE_TORQUE,
};

/// An input whose recorded values are limited. While its magnitude is at the limit, the true input exceeds the recorded one by
/// `excess`, the mean of the part that was cut off. The true input within a limited interval is not modelled.
pub(super) const AT_INPUT: Effect = Effect {
    id: EFFECT.id,
    name: EFFECT.name,
    acts_at: ActsAt::Channel,
    family: Family::Reading,
    places: Places::Inputs,
    parameters: &[
        EffectParameter::new("limit", QuantityKind::Gain, POSITIVE),
        EffectParameter::new("excess", QuantityKind::Gain, POSITIVE),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Reading],
        acts: Acts::Reading,
        rule: Rule::Code(cut_off),
        formula: "-0.5*excess*(1 + tanh(3000*(abs(reading)/limit - 0.999)))*sign(reading)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[1] == 0.0,
    }]),
    amplitude: Amplitude::of(&["excess"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        let limit = rig.channel(place).limit;
        limit.map(|limit| vec![("limit", limit), ("excess", 0.0)]).into_iter().collect()
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let largest = rig.channel(place).largest;
        let source = "a range that is too small ends at the largest readings, and is usually chosen nearly large enough";
        vec![
            ("limit", Prior::log_normal([largest, 1.01], (0.9 * largest, 1.01 * largest), source)),
            ("excess", Prior::log_normal([0.1 * largest, 3.0], (0.0, 2.0 * largest), source)),
        ]
    },
    discrepancy: &[Discrepancy::share(
        "excess",
        0.5,
        "the excess is a mean over what was cut off, and the true signal differs from it: 50 %",
    )],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "|u| = u_max: |u_true| = u_max + e",
    sentence: |_| "The input exceeds the largest value that is recorded: the range of its sensor, or its amplifier's, is too small.",
    shows: "at the limit of the input's readings",
    experiment: experiment::LARGE_TORQUE,
};

/// Relative distance from the limit within which a reading counts as limited.
const AT_LIMIT: f64 = 1e-3;

fn cut_off(law_inputs: &[f64], p: &[f64]) -> Response {
    let (reading, limit, excess) = (law_inputs[0], p[0], p[1]);
    let width = AT_LIMIT / 3.0;
    // `share` is 1 at the limit and 0 well below it.
    let (tanh, bend, _) = shape::sign(reading.abs() / limit - 1.0 + AT_LIMIT, width);
    let (share, derivative) = (0.5 * (1.0 + tanh), 0.5 * bend);
    let sign = reading.signum();
    shape::response(
        -excess * share * sign,
        &[-excess * derivative / limit],
        &[excess * derivative * reading / (limit * limit), -share * sign],
    )
}

/// Width of the rounded corners as a fraction of the limit.
const ROUNDING: f64 = 1e-6;

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let kept = shape::clip(law_inputs[0], p[0], ROUNDING * p[0]);
    shape::response(kept.value - law_inputs[0], &[kept.by_x - 1.0], &[kept.by_half])
}
