//! Dry friction that gives before it slips: the contact's bristles bend (P. R. Dahl, 1968; with less friction in motion than at
//! standstill, C. Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995, but for the bristles' own damping).

use super::{Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Sight, shape};

/// Coulomb friction: T = -torque z / deflection, z' = w - |w| z / deflection. `deflection` is the angle by which bristles give until two
/// thirds of the torque are reached; a contact that sticks is a spring of torque / deflection.
pub(super) const COULOMB: Effect = Effect {
    id: "coulomb_friction",
    acts_at: ActsAt::Bearing,
    parameters: &[
        EffectParameter::new("torque", Kind::Torque, POSITIVE),
        EffectParameter::new("deflection", Kind::Angle, POSITIVE),
        TRANSITION,
    ],
    borrows: None,
    form: Form::Laws(&[
        Law {
            sights: &[Sight::Speed, Sight::State],
            acts: Acts::State,
            answer: |sights, p| {
                let (rate, slopes, [.., by_deflection, by_transition]) = bend(sights, [p[1], p[2]], STEADY);
                shape::response(rate, &slopes, &[0.0, by_deflection, by_transition])
            },
            bend: |p| p[2],
            silent: shape::never,
        },
        Law {
            sights: &[Sight::State],
            acts: Acts::Torque,
            answer: |sights, p| {
                let (pull, by_state, by_deflection) = pull(sights[0], p[0], p[1]);
                shape::response(pull, &[by_state], &[-sights[0] / p[1], by_deflection])
            },
            bend: shape::straight,
            silent: |parameters| parameters[0] == 0.0,
        },
    ]),
    equation: "T = -T_c z/d, z' = w - |w| z/d",
    sentence: "Something rubs with a drag that does not grow with speed, and gives a little before it slips: a seal, a brake or a \
               preloaded bearing.",
};

/// Stribeck friction: T = -static_torque z / deflection, z' = w - |w| z static_torque / (deflection g(w)), where g is what friction is
/// in steady motion: torque + (static_torque - torque) exp(-(w / stribeck_speed)²).
pub(super) const STRIBECK: Effect = Effect {
    id: "stribeck_friction",
    acts_at: ActsAt::Bearing,
    parameters: &[
        EffectParameter::new("torque", Kind::Torque, POSITIVE),
        EffectParameter::new("static_torque", Kind::Torque, POSITIVE),
        EffectParameter::new("stribeck_speed", Kind::Speed, POSITIVE),
        EffectParameter::new("deflection", Kind::Angle, POSITIVE),
        TRANSITION,
    ],
    borrows: None,
    form: Form::Laws(&[
        Law {
            sights: &[Sight::Speed, Sight::State],
            acts: Acts::State,
            answer: |sights, p| {
                let (rate, slopes, by_parameters) = bend(sights, [p[3], p[4]], ease(sights[0], p));
                shape::response(rate, &slopes, &by_parameters)
            },
            bend: |p| p[4],
            silent: shape::never,
        },
        Law {
            sights: &[Sight::State],
            acts: Acts::Torque,
            answer: |sights, p| {
                let (pull, by_state, by_deflection) = pull(sights[0], p[1], p[3]);
                shape::response(pull, &[by_state], &[0.0, -sights[0] / p[3], 0.0, by_deflection])
            },
            bend: shape::straight,
            silent: |parameters| parameters[1] == 0.0,
        },
    ]),
    equation: "T = -T_s z/d, z' = w - |w| z T_s/(d g), g = T_c + (T_s - T_c) exp(-(w/w_s)^2)",
    sentence: "Something rubs, sticks harder than it slides, and gives a little before it slips: a dry or starved bearing, a seal, a brake pad.",
};

/// Speed, rad/s (m/s), below which bristles bend back rather than slip: their law has a corner there, and this rounds it.
const TRANSITION: EffectParameter = EffectParameter::usual("transition_speed", Kind::Speed, (5e-3, 2e-4));

/// How much sooner bristles slip than those of the static torque: T_s / g, its slope by speed, and those by the parameters.
pub(super) struct Ease {
    value: f64,
    by_speed: f64,
    by_parameters: [f64; 3],
}

/// Where friction is the same at any speed.
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

/// Rate of the bristles' bend, its slopes by sights, and those by the ease's parameters, deflection and transition speed.
pub(super) fn bend(
    sights: &[f64],
    [deflection, transition]: [f64; 2],
    ease: Ease,
) -> (f64, [f64; 2], [f64; 5]) {
    let (speed, share) = (sights[0], sights[1] / deflection);
    let (sign, steepness, by_width) = shape::sign(speed, transition);
    let size = speed * sign;
    let [first, second, third] = ease.by_parameters.map(|slope| -size * share * slope);
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

/// Torque of bent bristles, its slope by the bend and by deflection.
pub(super) fn pull(bent: f64, torque: f64, deflection: f64) -> (f64, f64, f64) {
    let share = bent / deflection;
    (-torque * share, -torque / deflection, torque * share / deflection)
}
