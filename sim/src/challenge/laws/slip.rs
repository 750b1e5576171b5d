//! A coupling that slips above a torque: one slider carries all of its spring.

use socam_model::effects::{ActsAt, Borrowed, Effect, Kind, Response, Sight};

use super::{effect, number, response, sliders::slide, state, torque};

/// The state is what is wound up of the spring.
pub(in crate::challenge) static SLIP: Effect = effect(
    "sliding_clamp",
    ActsAt::Spring,
    &[number("torque", Kind::Torque)],
    Some(Borrowed::Stiffness),
    &[
        state(&[Sight::TwistRate, Sight::State], |sights, p| slide(sights, p[0] / p[1])),
        torque(&[Sight::Twist, Sight::State], relief),
    ],
    "T = k z, |T| <= T_s",
);

fn relief(sights: &[f64], p: &[f64]) -> Response {
    response(p[1] * (sights[1] - sights[0]), &[-p[1], p[1]])
}
