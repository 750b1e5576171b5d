//! Torsion of a shaft that the model takes to be rigid.

use super::{
    definition::{
        ActsAt, Amplitude, Coordinate, Discrepancy, Effect, EffectParameter, Family, Form, Linearisation,
        POSITIVE, Places, Prior, QuantityKind, Steady,
    },
    experiment, usual,
};

/// Replaces a rigid shaft by a spring and a damper in parallel.
pub(super) const EFFECT: Effect = Effect {
    id: "missing_compliance",
    name: "missing compliance",
    acts_at: ActsAt::Shaft,
    family: Family::Elastic,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("stiffness", QuantityKind::Stiffness, POSITIVE),
        EffectParameter::new("damping", QuantityKind::Damping, POSITIVE),
    ],
    borrows: None,
    form: Form::Compliance,
    amplitude: Amplitude { parameters: &["stiffness"], null: f64::INFINITY, coordinate: Coordinate::Inverse },
    linearisation: Linearisation::Restarts,
    starts: |rig, _| {
        let rigid = rig.rigid_stiffness();
        RELAXATION_S
            .map(|relaxation_s| vec![("stiffness", rigid), ("damping", rigid * relaxation_s)])
            .to_vec()
    },
    fit_starts: |rig, place, _, _| {
        let softest = rig.shaft(place).softest_beside.min(rig.rigid_stiffness());
        let stiffnesses = STIFFER.map(|times| times * softest);
        let each = stiffnesses.iter().flat_map(|k| SPRINGS_BACK_S.map(|relaxation_s| (*k, k * relaxation_s)));
        each.map(|(k, c)| vec![("stiffness", k), ("damping", c)]).collect()
    },
    priors: |rig, place| {
        let softest = rig.shaft(place).softest_beside.min(rig.rigid_stiffness());
        let source = "a part that was taken to be rigid is stiffer than the springs beside it, usually about ten times";
        let damping = "the damping of metal parts is about a millisecond times their stiffness";
        vec![
            ("stiffness", Prior::log_normal([10.0 * softest, 5.0], (0.1 * softest, 1e3 * softest), source)),
            ("damping", Prior::log_normal([1e-2 * softest, 10.0], (0.0, 10.0 * softest), damping)),
        ]
    },
    discrepancy: &[Discrepancy::share(
        "stiffness",
        1e-3,
        "assumed: no machine follows a law better than to 0.1 %",
    )],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "T = k d + c d'",
    sentence: |_| "A shaft that was taken to be rigid twists: a thin section, a key, a soft clamp.",
    shows: "fast motion",
    experiment: experiment::FAST_MOTION,
};

/// Relaxation times (damping over stiffness) of the nearly rigid shafts at which the score test linearises, s.
const RELAXATION_S: [f64; 3] = [1e-6, 3e-3, 3e-2];
/// Start stiffnesses of a fit, as multiples of the softest spring beside the shaft. Sensitivities at a rigid shaft cannot predict its
/// stiffness, because the compliance depends on 1/stiffness and a damper in parallel reduces its influence; several starts are used.
const STIFFER: [f64; 2] = [3.0, 30.0];
/// Start relaxation times (damping over stiffness) of a fit, s.
const SPRINGS_BACK_S: [f64; 3] = [1e-4, 3e-3, 2e-2];
