//! Drag that grows with the square of speed.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Discrepancy, Effect, EffectParameter, Family, Form, Law, LawInput,
        Linearisation, Places, Prior, QuantityKind, Response, Rule, Steady, all_zero, begin_with_little,
    },
    experiment, shape, usual,
};

/// T = -coefficient speed |speed|.
pub(super) const EFFECT: Effect = Effect {
    id: "quadratic_drag",
    name: "quadratic drag",
    acts_at: ActsAt::Bearing,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[EffectParameter::new("coefficient", QuantityKind::Drag, ANY)],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Speed],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "-coefficient*speed*abs(speed)",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["coefficient"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["coefficient"]),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let (bearing, node) = rig.bearing(place);
        let most = node.torque / (node.speed * node.speed);
        // The total drag at the largest speed is not negative.
        let least = -bearing.damping / node.speed;
        let source = "windage takes less than the torque that moves the axis at its largest speed, and drag is not negative";
        vec![("coefficient", Prior::normal([0.0, 0.2 * most], (least, most), source))]
    },
    discrepancy: &[Discrepancy::amplitude("coefficient")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Linear,
    equation: "T = -b w |w|",
    sentence: |fitted| {
        if fitted.get("coefficient") < 0.0 {
            "The drag grows less than in proportion to speed: grease that shears thin, or a seal that lifts."
        } else {
            "Something churns air or oil: a fan, a disc in a bath, a windage loss."
        }
    },
    shows: "high speeds",
    experiment: experiment::LARGE_TORQUE,
};

fn evaluate(law_inputs: &[f64], parameters: &[f64]) -> Response {
    let (speed, size) = (law_inputs[0], law_inputs[0].abs());
    shape::response(-parameters[0] * speed * size, &[-2.0 * parameters[0] * size], &[-speed * size])
}
