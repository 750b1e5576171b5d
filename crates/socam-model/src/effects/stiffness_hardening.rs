//! A coupling whose stiffness depends on its twist.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Borrowed, Condition, Discrepancy, Effect, EffectParameter, Equivalent,
        Family, Form, Law, LawInput, Linearisation, Places, Prior, QuantityKind, Response, Rule, Steady,
        all_zero, begin_with_little,
    },
    experiment, shape, usual,
};

/// T = k d (1 + cubic d²), with twist d; a negative `cubic` softens.
pub(super) const EFFECT: Effect = Effect {
    id: "stiffness_hardening",
    name: "stiffness hardening",
    acts_at: ActsAt::Spring,
    family: Family::Elastic,
    places: Places::Every,
    parameters: &[EffectParameter::new("cubic", QuantityKind::PerAngleSquared, ANY)],
    borrows: Some(Borrowed::Stiffness),
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Twist],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "stiffness*cubic*twist^3",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["cubic"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["cubic"]),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let spring = rig.spring(place);
        let twist = spring.torque / spring.stiffness;
        let source = "a coupling that stiffens more than tenfold at the twist seen is a stop; one that softens keeps some of its stiffness";
        let per_twist = 1.0 / (twist * twist);
        vec![("cubic", Prior::normal([0.0, per_twist], (-0.4 * per_twist, 10.0 * per_twist), source))]
    },
    discrepancy: &[Discrepancy::amplitude("cubic")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[Equivalent { effect: "stiffness_hardening", holds: Condition::InSeriesWithFreeStiffness }],
    steady: Steady::Unseen,
    equation: "T = k d (1 + a d^2)",
    sentence: |fitted| {
        if fitted.get("cubic") < 0.0 {
            "A coupling is softer the more it is wound up: rubber that gives, or a clamp that begins to yield."
        } else if fitted.get("cubic") > 0.0 {
            "A coupling is stiffer the more it is wound up: rubber, or a spring near its stop."
        } else {
            "A coupling is stiffer the more it is wound up, or softer: rubber, or a spring near its stop."
        }
    },
    shows: "large torques",
    experiment: experiment::LARGE_TORQUE,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (square, cubic, stiffness) = (law_inputs[0] * law_inputs[0], p[0], p[1]);
    let cube = square * law_inputs[0];
    shape::response(
        stiffness * cubic * cube,
        &[3.0 * stiffness * cubic * square],
        &[stiffness * cube, cubic * cube],
    )
}
