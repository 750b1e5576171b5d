//! Inertia that the model does not contain.

use super::{
    definition::{
        ANY, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family, Form,
        Linearisation, Places, Prior, QuantityKind, Steady,
    },
    experiment, usual,
};

/// Additional inertia at a node, J = J_0 + inertia; negative where the model's value is too large.
pub(super) const EFFECT: Effect = Effect {
    id: "missing_inertia",
    name: "missing inertia",
    acts_at: ActsAt::Node,
    family: Family::Load,
    places: Places::Free,
    parameters: &[EffectParameter::new("inertia", QuantityKind::Inertia, ANY)],
    borrows: None,
    form: Form::Inertia,
    amplitude: Amplitude::of(&["inertia"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        // 0 at a node with inertia. At a massless node a small positive value, because an inertia changes the number of states.
        let known = rig.nodes.iter().filter_map(|node| node.inertia);
        let trifle = TRIFLE * known.fold(1.0, f64::min);
        vec![vec![("inertia", if rig.node(place).inertia.is_some() { 0.0 } else { trifle })]]
    },
    fit_starts: |_, _, little, all| {
        // From a small inertia, the frequency of the additional mode crosses those of the other modes, and a fit may stop at a local minimum.
        vec![little.clone(), all.clone()]
    },
    priors: |rig, place| {
        let own = rig.node(place).inertia.unwrap_or(0.0);
        let all = rig.nodes.iter().filter_map(|node| node.inertia).fold(0.0, f64::max);
        let source = "a hub or fixture that was not counted weighs less than what was, usually a fifth; no part has less than none";
        let usual = if own > 0.0 { 0.2 * own } else { 0.05 * all };
        vec![("inertia", Prior::normal([0.0, usual], (-own, 10.0 * all), source))]
    },
    discrepancy: &[Discrepancy::amplitude("inertia")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[Equivalent {
        effect: "missing_inertia",
        holds: Condition::Stated("at another point of the same rigid body, or across a rigid gear"),
    }],
    steady: Steady::Unseen,
    equation: "J = J_0 + dJ",
    sentence: |fitted| {
        if fitted.get("inertia") < 0.0 {
            "The model contains too much inertia: the drawing's inertia is too large."
        } else {
            "Something turns along that the model does not contain: a hub, a coupling half, a fixture."
        }
    },
    shows: "fast motion",
    experiment: experiment::FAST_MOTION,
};

/// Start inertia of a massless node as a fraction of the smallest inertia of the model.
const TRIFLE: f64 = 1e-3;
