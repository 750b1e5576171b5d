//! Dry friction as the bending of bristles (Canudas de Wit et al. 1995, "LuGre"): it sticks, and breaks away.

use socam_model::effects::{ActsAt, Effect, Kind, Response, Sight};

use super::{effect, number, response, size, state, torque};

/// `torque` at speed, `static_torque` at standstill, and the angle by which bristles bend at `torque`.
pub(in crate::challenge) static BRISTLES: Effect = effect(
    "bristle_friction",
    ActsAt::Bearing,
    &[
        number("torque", Kind::Torque),
        number("static_torque", Kind::Torque),
        number("stribeck_speed", Kind::Speed),
        number("deflection", Kind::Angle),
    ],
    None,
    &[state(&[Sight::Speed, Sight::State], bend), torque(&[Sight::Speed, Sight::State], pull)],
    "z' = w - s0 |w| z / g(w), T = -(s0 z + s1(w) z')",
);

/// Of the modulus of speed, rad/s.
const ROUNDING: f64 = 1e-6;
/// Bristles are damped with their stiffness times so much, s, at standstill ...
const DAMPING_TIME_S: f64 = 2e-4;
/// ... and no longer beyond about this speed, rad/s.
const DAMPED_BELOW: f64 = 0.1;

fn bend(sights: &[f64], p: &[f64]) -> Response {
    let (speed, bent) = (sights[0], sights[1]);
    let ratio = speed / p[2];
    let excess = (p[1] - p[0]) * (-ratio * ratio).exp();
    let level = p[0] + excess;
    let level_slope = -2.0 * excess * ratio / p[2];
    let stiffness = p[0] / p[3];
    let (modulus, modulus_slope) = size(speed, ROUNDING);
    let pace = stiffness * modulus / level;
    let pace_slope = stiffness * (modulus_slope - modulus * level_slope / level) / level;
    response(speed - pace * bent, &[1.0 - pace_slope * bent, -pace])
}

fn pull(sights: &[f64], p: &[f64]) -> Response {
    let (speed, bent) = (sights[0], sights[1]);
    let stiffness = p[0] / p[3];
    let part = speed / DAMPED_BELOW;
    let damping = stiffness * DAMPING_TIME_S / (1.0 + part * part);
    let damping_slope = -2.0 * damping * part / ((1.0 + part * part) * DAMPED_BELOW);
    let rate = bend(sights, p);
    response(
        -(stiffness * bent + damping * rate.torque),
        &[-(damping_slope * rate.torque + damping * rate.slopes[0]), -(stiffness + damping * rate.slopes[1])],
    )
}
