//! Viscous damping of a bearing that changes linearly in time.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Borrowed, Discrepancy, Effect, EffectParameter, Family, Form, Law,
        LawInput, Linearisation, Places, Prior, QuantityKind, Response, Rule, Steady, all_zero,
        begin_with_little,
    },
    experiment, shape, usual,
};

/// T = -damping rate time speed, added to the bearing's own torque -damping speed.
pub(super) const EFFECT: Effect = Effect {
    id: "damping_drift",
    name: "damping drift",
    acts_at: ActsAt::Bearing,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[EffectParameter::new("rate", QuantityKind::Rate, ANY)],
    borrows: Some(Borrowed::Damping),
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Speed, LawInput::Time],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "-damping*rate*time*speed",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["rate"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["rate"]),
    fit_starts: begin_with_little,
    priors: |rig, _| {
        let per_recording = 1.0 / rig.longest_s;
        let source = "grease that warms up changes its damping by some tens of per cent within a recording, and never below zero";
        vec![(
            "rate",
            Prior::normal([0.0, 0.5 * per_recording], (-per_recording, 5.0 * per_recording), source),
        )]
    },
    discrepancy: &[Discrepancy::amplitude("rate")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "c = c_0 (1 + r t)",
    sentence: |fitted| {
        if fitted.get("rate") < 0.0 {
            "The drag falls while the bench runs: grease that warms up, or a seal that runs in."
        } else if fitted.get("rate") > 0.0 {
            "The drag rises while the bench runs: a bearing that heats up and tightens, or a brake that drags more and more."
        } else {
            "The drag changes while the bench runs: grease that warms up, or a brake that fades."
        }
    },
    shows: "late in a recording, compared with its beginning",
    experiment: experiment::LARGE_TORQUE,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (speed, time) = (law_inputs[0], law_inputs[1]);
    let (rate, damping) = (p[0], p[1]);
    shape::response(
        -damping * rate * time * speed,
        &[-damping * rate * time, -damping * rate * speed],
        &[-damping * time * speed, -rate * time * speed],
    )
}
