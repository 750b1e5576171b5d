//! Drag that grows with the square of speed.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, Response, Sight, shape};

/// T = -coefficient speed |speed|.
pub(super) const EFFECT: Effect = Effect {
    id: "quadratic_drag",
    acts_at: ActsAt::Bearing,
    parameters: &[EffectParameter::new("coefficient", Kind::Drag, ANY)],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Speed],
        acts: Acts::Torque,
        answer,
        bend: shape::straight,
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "T = -b w |w|",
    sentence: "Something churns air or oil: a fan, a disc in a bath, a windage loss.",
};

fn answer(sights: &[f64], parameters: &[f64]) -> Response {
    let (speed, size) = (sights[0], sights[0].abs());
    shape::response(-parameters[0] * speed * size, &[-2.0 * parameters[0] * size], &[-speed * size])
}
