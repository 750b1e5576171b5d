//! Drag that grows with the square of speed, and slower below a speed.

use socam_model::effects::{ActsAt, Effect, Kind, Response, Sight};

use super::{effect, number, response, torque};

/// Laminar below `laminar_speed`.
pub(in crate::challenge) static DRAG: Effect = effect(
    "rounded_drag",
    ActsAt::Bearing,
    &[number("coefficient", Kind::Drag), number("laminar_speed", Kind::Speed)],
    None,
    &[torque(&[Sight::Speed], drag)],
    "T = -b w sqrt(w^2 + w_l^2)",
);

fn drag(sights: &[f64], p: &[f64]) -> Response {
    let speed = sights[0];
    let root = speed.hypot(p[1]);
    response(-p[0] * speed * root, &[-p[0] * (root + speed * speed / root)])
}
