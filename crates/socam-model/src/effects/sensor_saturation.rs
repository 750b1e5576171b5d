//! A sensor that cannot read more.

use super::{Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, shape};

/// reading = truth, but within -limit .. limit.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_saturation",
    acts_at: ActsAt::Channel,
    parameters: &[EffectParameter::new("limit", Kind::Gain, POSITIVE)],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Reading],
        acts: Acts::Reading,
        answer,
        bend: shape::straight,
        silent: shape::never,
    }]),
    equation: "|y| <= y_max",
    sentence: "A sensor's peaks are cut off: its range, or its amplifier's, is too small.",
};

/// Of the corners, as a part of the limit.
const ROUNDING: f64 = 1e-6;

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let kept = shape::clip(sights[0], p[0], ROUNDING * p[0]);
    shape::response(kept.value - sights[0], &[kept.by_x - 1.0], &[kept.by_half])
}
