//! A shaft that was taken to be rigid and is not.

use super::{
    definition::{
        ActsAt, Amplitude, Coordinate, Discrepancy, Effect, EffectParameter, Form, Kind, Linearisation,
        POSITIVE, Places, Prior, Steady,
    },
    experiment,
};

/// A spring and damper in the shaft's place.
pub(super) const EFFECT: Effect = Effect {
    id: "missing_compliance",
    name: "missing compliance",
    acts_at: ActsAt::Shaft,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("stiffness", Kind::Stiffness, POSITIVE),
        EffectParameter::new("damping", Kind::Damping, POSITIVE),
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
        let source = "a part that was taken to be rigid is stiffer than what stands beside it, usually by some ten times";
        let damping = "parts spring back within milliseconds";
        vec![
            ("stiffness", Prior::log_normal([10.0 * softest, 5.0], (0.1 * softest, 1e3 * softest), source)),
            ("damping", Prior::log_normal([1e-2 * softest, 10.0], (0.0, 10.0 * softest), damping)),
        ]
    },
    discrepancy: &[Discrepancy::share(
        "stiffness",
        1e-3,
        "assumed: no law is obeyed better than to a thousandth",
    )],
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "T = k d + c d'",
    sentence: |_| "A shaft that was taken to be rigid twists: a thin section, a key, a clamp that gives.",
    shows: "fast motion",
    experiment: experiment::FAST_MOTION,
};

/// How long a shaft that is as good as rigid may take to spring back, s.
const RELAXATION_S: [f64; 3] = [1e-6, 3e-3, 3e-2];
/// A shaft that may give begins so many times as stiff as the softest spring beside it, and springs back in so long, s. What it adds to a
/// twist goes with the inverse of its stiffness, and a damper beside it hides that: sensitivities at a rigid one predict neither.
const STIFFER: [f64; 2] = [3.0, 30.0];
const SPRINGS_BACK_S: [f64; 3] = [1e-4, 3e-3, 2e-2];
