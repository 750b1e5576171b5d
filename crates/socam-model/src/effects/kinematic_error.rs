//! A gear whose transmission error is a wave over the angle of its fast side.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Borrowed, Discrepancy, Effect, EffectParameter, Family, Form, Law,
        LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Response, Rule, Steady,
        begin_with_little, wave,
    },
    experiment, shape, usual,
};

/// The slow side leads by amplitude sin(order angle + phase), with the angle of the fast side. The law applies the torque that twists the
/// stiff spring of the contact by that angle.
pub(super) const EFFECT: Effect = Effect {
    id: "kinematic_error",
    name: "kinematic error",
    acts_at: ActsAt::Gear,
    family: Family::Periodic,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("order", QuantityKind::Ratio, POSITIVE),
        EffectParameter::new("amplitude", QuantityKind::Angle, POSITIVE),
        EffectParameter::new("phase", QuantityKind::Phase, ANY),
    ],
    borrows: Some(Borrowed::Stiffness),
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Angle],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "stiffness*amplitude*sin(order*angle + phase)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[1] == 0.0,
    }]),
    amplitude: Amplitude::of(&["amplitude"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        let ratio = rig.gear(place).0.ratio;
        let mut orders: Vec<f64> = (1..=4).map(f64::from).flat_map(|times| [times, times / ratio]).collect();
        orders.sort_by(f64::total_cmp);
        orders.dedup();
        orders.into_iter().map(|order| wave("order", order, "amplitude")).collect()
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let usual = if rig.rotational { 1e-3 } else { 1e-5 };
        let orders = "transmission errors have a whole number of periods per turn of either shaft";
        vec![
            ("order", Prior::whole_numbers(vec![1.0, 1.0 / rig.gear(place).0.ratio], 2e-3, 200.0, orders)),
            (
                "amplitude",
                Prior::log_normal(
                    [usual, 5.0],
                    (0.0, 0.1),
                    "transmission errors of gears: 0.2 to 20 arcmin; of screws, 2 to 50 um",
                ),
            ),
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
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "theta_out = theta_in / N + A sin(n theta_in + phi)",
    sentence: |_| "The reduction does not roll true: an eccentric cam, an indexing error of the rollers, once or more per turn.",
    shows: "a fixed number of times per turn",
    experiment: experiment::FAST_MOTION,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (sin, cos) = (p[0] * law_inputs[0] + p[2]).sin_cos();
    let (amplitude, stiffness) = (p[1], p[3]);
    let size = stiffness * amplitude;
    shape::response(
        size * sin,
        &[size * p[0] * cos],
        &[size * law_inputs[0] * cos, stiffness * sin, size * cos, amplitude * sin],
    )
}
