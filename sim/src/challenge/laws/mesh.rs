//! A mesh that eats a share of its torque.

use socam_model::effects::{Acts, ActsAt, Effect, Kind, Law, Response, Sight};

use super::{effect, number, response, sign};

/// A fraction of the torque that enters, from whichever side: T = -fraction |T| sign(w) while the fast side drives, more by 1 / (1 - fraction)
/// while the slow side does; corners rounded otherwise than in the catalogue.
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
    "|T_leaving| = (1 - f) |T_entering|",
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
    let by_tanh = (1.0 - tanh * tanh) / TORQUE_ROUNDING;
    let lost = p[0] / (1.0 - 0.5 * p[0] * (1.0 - sign * tanh));
    let by_sign = lost - 0.5 * lost * lost * sign * tanh;
    let by_torque = lost * slope - 0.5 * lost * lost * size * sign * by_tanh;
    response(-lost * size * sign, &[-by_sign * size * bend, -by_torque * sign])
}
