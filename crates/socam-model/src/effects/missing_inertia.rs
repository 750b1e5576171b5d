//! Inertia that nobody counted.

use super::{
    definition::{
        ANY, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Form, Kind,
        Linearisation, Places, Prior, Steady,
    },
    experiment,
};

/// More inertia at a node (less, where it is negative: then the drawing's value is too large).
pub(super) const EFFECT: Effect = Effect {
    id: "missing_inertia",
    name: "missing inertia",
    acts_at: ActsAt::Node,
    places: Places::Free,
    parameters: &[EffectParameter::new("inertia", Kind::Inertia, ANY)],
    borrows: None,
    form: Form::Inertia,
    amplitude: Amplitude::of(&["inertia"]),
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        // None where there is some already; a trifle where the model has none: a node with it moves by other equations than one without.
        let known = rig.nodes.iter().filter_map(|node| node.inertia);
        let trifle = TRIFLE * known.fold(1.0, f64::min);
        vec![vec![("inertia", if rig.node(place).inertia.is_some() { 0.0 } else { trifle })]]
    },
    fit_starts: |_, _, little, all| {
        // On the way from a little the mode that a mass brings crosses all others, and a fit stops at one of them.
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
    replaces: &[],
    equivalents: &[Equivalent {
        effect: "missing_inertia",
        holds: Condition::Stated("at another point of the same rigid body, or across a rigid gear"),
    }],
    steady: Steady::Unseen,
    equation: "J = J_0 + dJ",
    sentence: |fitted| {
        if fitted.get("inertia") < 0.0 {
            "Less turns along than was counted: the drawing's inertia is too large."
        } else {
            "Something turns along that was not counted: a hub, a coupling half, a fixture."
        }
    },
    shows: "fast motion",
    experiment: experiment::FAST_MOTION,
};

/// Inertia that is as good as none, as a share of the least there is.
const TRIFLE: f64 = 1e-3;
