//! A coupling that slips above a limiting torque.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Borrowed, Condition, Coordinate, Discrepancy, Effect, EffectParameter,
        Equivalent, Family, Form, Law, LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind,
        Response, Rule, Steady, begin_with_little,
    },
    experiment, shape, usual,
};

/// T = k (d - s) with twist d and slip s: s' = v where the magnitude of T has reached `torque` and v increases it, otherwise 0 (v = d').
/// The switch is rounded: s' = max(v sign T, 0) sign T (|T| / torque)^16.
pub(super) const EFFECT: Effect = Effect {
    id: "coupling_slip",
    name: "coupling slip",
    acts_at: ActsAt::Spring,
    family: Family::Elastic,
    places: Places::Every,
    parameters: &[EffectParameter::new("torque", QuantityKind::Torque, POSITIVE)],
    borrows: Some(Borrowed::Stiffness),
    form: Form::Laws(&[
        Law {
            law_inputs: &[LawInput::TwistRate, LawInput::Twist, LawInput::State],
            acts: Acts::State,
            rule: Rule::Code(slip),
            formula: "0.5*(twist_rate*sign(twist - state) + sqrt(twist_rate^2 + \
                      1e-4))*min((stiffness*(twist - state)/torque)^2, 4)^8*sign(twist - state)",
            transition: shape::no_transition,
            inactive: shape::never,
        },
        Law {
            law_inputs: &[LawInput::State],
            acts: Acts::Torque,
            rule: Rule::Code(relief),
            formula: "-stiffness*state",
            transition: shape::no_transition,
            inactive: shape::never,
        },
    ]),
    amplitude: Amplitude { parameters: &["torque"], null: f64::INFINITY, coordinate: Coordinate::Value },
    linearisation: Linearisation::NonNull,
    starts: |rig, place| {
        let torque = rig.spring(place).torque;
        [0.9, 0.7].map(|share| vec![("torque", share * torque)]).to_vec()
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let torque = rig.spring(place).torque;
        let source = "a coupling that slips is seen only below the largest torque through it; one that slips at a tenth drives nothing";
        vec![("torque", Prior::log_normal([0.6 * torque, 2.0], (0.02 * torque, 1.1 * torque), source))]
    },
    discrepancy: &[Discrepancy::share(
        "torque",
        2e-2,
        "assumed: a real coupling does not slip by a rounded step",
    )],
    usual: usual::never,
    replaces: &[],
    equivalents: &[Equivalent { effect: "coupling_slip", holds: Condition::InSeries }],
    steady: Steady::Slips,
    equation: "|T| <= T_slip",
    sentence: |_| "A coupling slips when the torque exceeds what its clamp or key holds, and does not slip back.",
    shows: "large torques",
    experiment: experiment::LARGE_TORQUE,
};

/// Half of the exponent of |T| / torque.
const HALF_POWER: i32 = 8;
/// Rate of twist over which the corner of max(v, 0) is rounded, rad/s.
const ROUNDING: f64 = 1e-2;

fn slip(law_inputs: &[f64], p: &[f64]) -> Response {
    let (rate, wound) = (law_inputs[0], law_inputs[1] - law_inputs[2]);
    let (limit, stiffness) = (p[0], p[1]);
    let share = stiffness * wound / limit;
    let power = (share * share).min(4.0).powi(HALF_POWER);
    // max(v sign(share), 0), rounded: the coupling slips only where the twist increases.
    let towards = rate * share.signum();
    let root = (towards * towards + ROUNDING * ROUNDING).sqrt();
    let (onward, by_rate) = (0.5 * (towards + root), 0.5 * (1.0 + towards / root));
    let value = onward * power * share.signum();
    let still = f64::from(share * share < 4.0);
    let by_share = still * 2.0 * f64::from(HALF_POWER) * onward * power / share.abs().max(1e-12);
    let by_wound = by_share * stiffness / limit;
    shape::response(
        value,
        &[by_rate * power, by_wound, -by_wound],
        &[-by_share * share / limit, by_share * wound / limit],
    )
}

fn relief(law_inputs: &[f64], p: &[f64]) -> Response {
    shape::response(-p[1] * law_inputs[0], &[-p[1]], &[0.0, -law_inputs[0]])
}
