//! A mesh that eats a share of its torque.

use socam_model::effects::{Acts, ActsAt, Effect, Kind, Law, Response, Sight};

use super::{effect, number, response, sign};

/// T = -fraction |T| sign(w), corners rounded otherwise than in the catalogue.
pub(in crate::challenge) static LOSS: Effect = effect(
    "sliding_mesh",
    ActsAt::Gear,
    &[number("fraction", Kind::Ratio)],
    None,
    &[Law {
        sights: &[Sight::Speed, Sight::Torque],
        acts: Acts::Drag,
        answer: loss,
        bend: |_| 0.0,
        silent: |_| false,
    }],
    "T = -f |T| sign(w)",
);

/// rad/s.
const SPEED_ROUNDING: f64 = 0.02;
/// N m.
const TORQUE_ROUNDING: f64 = 0.02;

fn loss(sights: &[f64], p: &[f64]) -> Response {
    let (sign, bend) = sign(sights[0], SPEED_ROUNDING);
    let share = sights[1] / TORQUE_ROUNDING;
    let tanh = share.tanh();
    let (size, slope) = (sights[1] * tanh, tanh + share * (1.0 - tanh * tanh));
    response(-p[0] * size * sign, &[-p[0] * size * bend, -p[0] * slope * sign])
}
