//! Dry friction with presliding: the contact deflects elastically before it slips. Coulomb friction as by P. R. Dahl, 1968; Stribeck
//! friction as by C. Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995 (the LuGre law), without the damping of the bristles.

use super::{
    coulomb_friction,
    definition::{
        Acts, ActsAt, Discrepancy, Effect, EffectParameter, Family, FittedValues, Form, Law, LawInput,
        Linearisation, POSITIVE, Places, Prior, QuantityKind, Replaces, Rig, Rule, Steady, Values,
        begin_with_little,
    },
    experiment, shape, stribeck_friction, usual,
};

/// Coulomb friction: T = -torque z / deflection, z' = w - |w| z / deflection. `z` is the deflection of the bristles, rad, and
/// `deflection` the angle after which 63 % of the torque is reached. A sticking contact is a spring of stiffness torque / deflection.
pub(super) const COULOMB: Effect = Effect {
    id: coulomb_friction::EFFECT.id,
    name: "Coulomb friction with presliding",
    acts_at: ActsAt::Bearing,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::new("deflection", QuantityKind::Angle, POSITIVE),
        TRANSITION,
    ],
    borrows: None,
    form: Form::Laws(&[
        Law {
            law_inputs: &[LawInput::Speed, LawInput::State],
            acts: Acts::State,
            rule: Rule::Code(|law_inputs, p| {
                let (rate, derivatives, [.., by_deflection, by_transition]) =
                    bend(law_inputs, [p[1], p[2]], STEADY);
                shape::response(rate, &derivatives, &[0.0, by_deflection, by_transition])
            }),
            formula: "speed - speed*tanh(speed/transition_speed)*state/deflection",
            transition: |p| p[2],
            inactive: shape::never,
        },
        Law {
            law_inputs: &[LawInput::State],
            acts: Acts::Torque,
            rule: Rule::Code(|law_inputs, p| {
                let (pull, by_state, by_deflection) = pull(law_inputs[0], p[0], p[1]);
                shape::response(pull, &[by_state], &[-law_inputs[0] / p[1], by_deflection])
            }),
            formula: "-torque*state/deflection",
            transition: shape::no_transition,
            inactive: |parameters| parameters[0] == 0.0,
        },
    ]),
    amplitude: coulomb_friction::EFFECT.amplitude,
    linearisation: Linearisation::Null,
    starts: |rig, place| {
        // Presliding is visible only where the bearing comes to rest.
        let comes_to_rest = rig.bearing(place).1.rest_share > RESTS;
        let middle = deflections(rig)[1];
        let start = vec![("torque", 0.0), ("deflection", middle)];
        if comes_to_rest { vec![start] } else { Vec::new() }
    },
    fit_starts: |rig, _, little, _| with_deflections(rig, vec![little.clone()]),
    priors: |rig, place| {
        let mut all = (coulomb_friction::EFFECT.priors)(rig, place);
        all.push(deflection(rig));
        all
    },
    discrepancy: &[Discrepancy::amplitude("torque"), BENT],
    usual: usual::never,
    // Presliding and friction that falls with speed both explain a gradual start of the motion.
    replaces: &[
        Replaces { law: coulomb_friction::EFFECT.id, starts: giving },
        Replaces { law: stribeck_friction::EFFECT.id, starts: giving },
    ],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "T = -T_c z/d, z' = w - |w| z/d",
    sentence: |_| {
        "Something rubs with a drag that does not grow with speed, and gives a little before it slips: a seal, a brake or a preloaded \
         bearing."
    },
    shows: coulomb_friction::EFFECT.shows,
    experiment: experiment::THROUGH_STANDSTILL,
};

/// Stribeck friction: T = -static_torque z / deflection, z' = w - |w| z static_torque / (deflection g(w)), where g is the friction in
/// steady motion: torque + (static_torque - torque) exp(-(w / stribeck_speed)²).
pub(super) const STRIBECK: Effect = Effect {
    id: stribeck_friction::EFFECT.id,
    name: "Stribeck friction with presliding",
    acts_at: ActsAt::Bearing,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::new("static_torque", QuantityKind::Torque, POSITIVE),
        EffectParameter::new("stribeck_speed", QuantityKind::Speed, POSITIVE),
        EffectParameter::new("deflection", QuantityKind::Angle, POSITIVE),
        TRANSITION,
    ],
    borrows: None,
    form: Form::Laws(&[
        Law {
            law_inputs: &[LawInput::Speed, LawInput::State],
            acts: Acts::State,
            rule: Rule::Code(|law_inputs, p| {
                let (rate, derivatives, by_parameters) =
                    bend(law_inputs, [p[3], p[4]], ease(law_inputs[0], p));
                shape::response(rate, &derivatives, &by_parameters)
            }),
            formula: "speed - speed*tanh(speed/transition_speed)*state/deflection*static_torque/(torque + \
                      (static_torque - torque)*exp(-(speed/stribeck_speed)^2))",
            transition: |p| p[4],
            inactive: shape::never,
        },
        Law {
            law_inputs: &[LawInput::State],
            acts: Acts::Torque,
            rule: Rule::Code(|law_inputs, p| {
                let (pull, by_state, by_deflection) = pull(law_inputs[0], p[1], p[3]);
                shape::response(pull, &[by_state], &[0.0, -law_inputs[0] / p[3], 0.0, by_deflection])
            }),
            formula: "-static_torque*state/deflection",
            transition: shape::no_transition,
            inactive: |parameters| parameters[1] == 0.0,
        },
    ]),
    amplitude: stribeck_friction::EFFECT.amplitude,
    linearisation: Linearisation::Null,
    starts: |rig, place| with_deflections(rig, (stribeck_friction::EFFECT.starts)(rig, place)),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let mut all = (stribeck_friction::EFFECT.priors)(rig, place);
        all.push(deflection(rig));
        all
    },
    discrepancy: &[Discrepancy::amplitude("torque"), Discrepancy::amplitude("static_torque"), BENT],
    usual: usual::never,
    replaces: &[Replaces { law: stribeck_friction::EFFECT.id, starts: giving }],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "T = -T_s z/d, z' = w - |w| z T_s/(d g), g = T_c + (T_s - T_c) exp(-(w/w_s)^2)",
    sentence: |fitted| {
        if fitted.get("static_torque") < fitted.get("torque") {
            "Something rubs, less at standstill than in motion, and gives a little before it slips: a lubricated bearing or seal."
        } else {
            "Something rubs, sticks harder than it slides, and gives a little before it slips: a dry or starved bearing, a seal, a brake \
             pad."
        }
    },
    shows: stribeck_friction::EFFECT.shows,
    experiment: experiment::THROUGH_STANDSTILL,
};

/// Speed, rad/s (m/s), over which the corner of |w| at standstill is rounded.
pub(super) const TRANSITION: EffectParameter =
    EffectParameter::usual("transition_speed", QuantityKind::Speed, (5e-3, 2e-4));

/// Start deflections, rad; for translation in units of 0.01 m.
const DEFLECTIONS: [f64; 3] = [1e-4, 1e-3, 1e-2];

/// Least fraction of the time at rest for which the law is tested.
const RESTS: f64 = 0.02;

/// Model discrepancy of the deflection.
pub(super) const BENT: Discrepancy =
    Discrepancy::share("deflection", 1e-3, "assumed: no machine follows a law better than to 0.1 %");

pub(super) fn deflections(rig: &Rig) -> [f64; 3] {
    DEFLECTIONS.map(|deflection| if rig.rotational { deflection } else { 0.01 * deflection })
}

fn with_deflections(rig: &Rig, starts: Vec<Values>) -> Vec<Values> {
    let each = starts.iter().flat_map(|start| {
        let others = || start.iter().copied().filter(|(name, _)| *name != "deflection");
        let with = |deflection| others().chain([("deflection", deflection)]).collect();
        deflections(rig).map(with)
    });
    each.collect()
}

/// Starts of the deflection where a law with presliding replaces one without: the fitted deflection if there is one, else a grid.
pub(super) fn giving(rig: &Rig, fitted: &FittedValues<'_>) -> Vec<Values> {
    let known = fitted.get("deflection");
    if known.is_finite() {
        return vec![vec![("deflection", known)]];
    }
    deflections(rig).map(|deflection| vec![("deflection", deflection)]).to_vec()
}

pub(super) fn deflection(rig: &Rig) -> (&'static str, Prior) {
    let unit = if rig.rotational { 1.0 } else { 0.01 };
    let source = "presliding in the literature: 1 to 100 um at the contact, which are 1e-4 to 1e-2 rad at the radius of a bearing";
    ("deflection", Prior::log_normal([1e-3 * unit, 5.0], (1e-6 * unit, 0.3 * unit), source))
}

/// T_s / g, the factor of the slip rate, with its derivatives by the speed and by torque, static torque and Stribeck speed.
pub(super) struct Ease {
    value: f64,
    by_speed: f64,
    by_parameters: [f64; 3],
}

/// The factor where friction does not depend on the speed.
pub(super) const STEADY: Ease = Ease { value: 1.0, by_speed: 0.0, by_parameters: [0.0; 3] };

fn ease(speed: f64, p: &[f64]) -> Ease {
    let ratio = speed / p[2];
    let rest = (-ratio * ratio).exp();
    let level = p[0] + (p[1] - p[0]) * rest;
    let level_by_speed = -2.0 * (p[1] - p[0]) * rest * ratio / p[2];
    let value = p[1] / level;
    let by_level = -value / level;
    Ease {
        value,
        by_speed: by_level * level_by_speed,
        by_parameters: [
            by_level * (1.0 - rest),
            1.0 / level + by_level * rest,
            -by_level * level_by_speed * ratio,
        ],
    }
}

/// Rate of the bristles' deflection, rad/s; its derivatives by speed and deflection; its derivatives by the three parameters of `ease`, by
/// `deflection` and by the transition speed.
pub(super) fn bend(
    law_inputs: &[f64],
    [deflection, transition]: [f64; 2],
    ease: Ease,
) -> (f64, [f64; 2], [f64; 5]) {
    let (speed, share) = (law_inputs[0], law_inputs[1] / deflection);
    let (sign, steepness, by_width) = shape::sign(speed, transition);
    let size = speed * sign;
    let [first, second, third] = ease.by_parameters.map(|derivative| -size * share * derivative);
    let by_speed = 1.0 - share * ((sign + speed * steepness) * ease.value + size * ease.by_speed);
    (
        speed - size * share * ease.value,
        [by_speed, -size * ease.value / deflection],
        [
            first,
            second,
            third,
            size * share * ease.value / deflection,
            -speed * by_width * share * ease.value,
        ],
    )
}

/// Torque of the bristles, N m, and its derivatives by their deflection and by the parameter `deflection`.
pub(super) fn pull(bent: f64, torque: f64, deflection: f64) -> (f64, f64, f64) {
    let share = bent / deflection;
    (-torque * share, -torque / deflection, torque * share / deflection)
}
