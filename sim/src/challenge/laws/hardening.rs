//! A spring that stiffens with the square of its twist, and a little with the fourth power.

use socam_model::effects::{ActsAt, Borrowed, Effect, Kind, Response, Sight};

use super::{effect, number, response, torque};

/// T = k d (1 + cubic d² + quintic d⁴).
pub(in crate::challenge) static HARDENING: Effect = effect(
    "quintic_spring",
    ActsAt::Spring,
    &[number("cubic", Kind::PerAngleSquared), number("quintic", Kind::Gain)],
    Some(Borrowed::Stiffness),
    &[torque(&[Sight::Twist], more)],
    "T = k d (1 + a d^2 + b d^4)",
);

fn more(sights: &[f64], p: &[f64]) -> Response {
    let (twist, square) = (sights[0], sights[0] * sights[0]);
    let share = (p[0] + p[1] * square) * square;
    response(p[2] * twist * share, &[p[2] * (3.0 * p[0] + 5.0 * p[1] * square) * square])
}
