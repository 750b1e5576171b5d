//! Friction inside a coupling: it follows another way back than it went.

use super::{Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, shape};

/// A spring that yields, beside the elastic one: T = torque z / deflection, z' = v - |v| z / deflection (Dahl 1968; Bouc and
/// Wen with exponent one). `torque` is what it carries at most, `deflection` the twist that takes it to 63 % of that.
pub(super) const EFFECT: Effect = Effect {
    id: "hysteresis",
    acts_at: ActsAt::Spring,
    parameters: &[
        EffectParameter::new("torque", Kind::Torque, POSITIVE),
        EffectParameter::new("deflection", Kind::Angle, POSITIVE),
    ],
    borrows: None,
    form: Form::Laws(&[
        Law {
            sights: &[Sight::TwistRate, Sight::State],
            acts: Acts::State,
            answer: creep,
            bend: shape::straight,
            silent: shape::never,
        },
        Law {
            sights: &[Sight::State],
            acts: Acts::Torque,
            answer: pull,
            bend: shape::straight,
            silent: |parameters| parameters[0] == 0.0,
        },
    ]),
    equation: "T = T_y z/d_y, z' = v - |v| z/d_y",
    sentence: "A coupling rubs within itself: its torque lags behind its twist by a loop whose width hardly grows with speed.",
};

/// Of the twist's rate, rad/s: below it the modulus is rounded, such that nothing creeps at rest.
const ROUNDING: f64 = 0.02;

fn creep(sights: &[f64], p: &[f64]) -> Response {
    let (rate, state, deflection) = (sights[0], sights[1], p[1]);
    let (sign, bend, _) = shape::sign(rate, ROUNDING);
    let (size, share) = (rate * sign, state / deflection);
    shape::response(
        rate - size * share,
        &[1.0 - share * (sign + rate * bend), -size / deflection],
        &[0.0, size * share / deflection],
    )
}

fn pull(sights: &[f64], p: &[f64]) -> Response {
    let share = sights[0] / p[1];
    shape::response(p[0] * share, &[p[0] / p[1]], &[share, -p[0] * share / p[1]])
}
