//! A bearing that drags differently both ways.

use socam_model::effects::{ActsAt, Effect, Kind, Response, Sight};

use super::{effect, number, response, sign, torque};

/// As the catalogue's, with another rounding.
pub(in crate::challenge) static DIRECTION: Effect = effect(
    "one_way_drag",
    ActsAt::Bearing,
    &[number("torque_difference", Kind::Torque), number("damping_difference", Kind::Damping)],
    None,
    &[torque(&[Sight::Speed], drag)],
    "T = -(dT + dc |w|)/2",
);

/// rad/s.
const ROUNDING: f64 = 0.02;

fn drag(sights: &[f64], p: &[f64]) -> Response {
    let speed = sights[0];
    let (sign, bend) = sign(speed, ROUNDING);
    response(
        -0.5 * (p[0] * sign * sign + p[1] * speed * sign),
        &[-0.5 * (2.0 * p[0] * sign * bend + p[1] * (sign + speed * bend))],
    )
}
