//! A coupling that stiffens, or softens, as it winds up.

use super::{ANY, Acts, ActsAt, Borrowed, Effect, EffectParameter, Form, Kind, Law, Response, Sight, shape};

/// T = k d (1 + cubic d²).
pub(super) const EFFECT: Effect = Effect {
    id: "stiffness_hardening",
    acts_at: ActsAt::Spring,
    parameters: &[EffectParameter::new("cubic", Kind::PerAngleSquared, ANY)],
    borrows: Some(Borrowed::Stiffness),
    form: Form::Laws(&[Law {
        sights: &[Sight::Twist],
        acts: Acts::Torque,
        answer,
        bend: shape::straight,
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "T = k d (1 + a d^2)",
    sentence: "A coupling is stiffer the more it is wound up (or softer): rubber, or a spring near its stop.",
};

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let (square, cubic, stiffness) = (sights[0] * sights[0], p[0], p[1]);
    let cube = square * sights[0];
    shape::response(
        stiffness * cubic * cube,
        &[3.0 * stiffness * cubic * square],
        &[stiffness * cube, cubic * cube],
    )
}
