//! Friction inside a coupling: it follows another way back than it went.

use super::{
    Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, presliding, shape,
};

/// A spring that yields, beside the elastic one: T = torque z / deflection, z' = v - |v| z / deflection (Dahl 1968; Bouc and
/// Wen with exponent one). `torque` is what it carries at most, `deflection` the twist that takes it to 63 % of that.
/// Where the twist's rate is below `transition_speed`, the modulus is rounded, such that nothing creeps at rest.
pub(super) const EFFECT: Effect = Effect {
    id: "hysteresis",
    acts_at: ActsAt::Spring,
    parameters: &[
        EffectParameter::new("torque", Kind::Torque, POSITIVE),
        EffectParameter::new("deflection", Kind::Angle, POSITIVE),
        EffectParameter::usual("transition_speed", Kind::Speed, (0.02, 8e-4)),
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

fn creep(sights: &[f64], p: &[f64]) -> Response {
    let (rate, slopes, [.., by_deflection, by_width]) =
        presliding::bend(sights, [p[1], p[2]], presliding::STEADY);
    shape::response(rate, &slopes, &[0.0, by_deflection, by_width])
}

fn pull(sights: &[f64], p: &[f64]) -> Response {
    let (against, by_state, by_deflection) = presliding::pull(sights[0], p[0], p[1]);
    shape::response(-against, &[-by_state], &[sights[0] / p[1], -by_deflection])
}
