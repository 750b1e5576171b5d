//! A load whose centre of mass is off its axis.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, shape};

/// T = -torque sin(angle + phase), the angle counted from where the recording began.
pub(super) const EFFECT: Effect = Effect {
    id: "gravity_unbalance",
    acts_at: ActsAt::Node,
    parameters: &[
        EffectParameter::new("torque", Kind::Torque, POSITIVE),
        EffectParameter::new("phase", Kind::Phase, ANY),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Angle],
        acts: Acts::Torque,
        answer,
        bend: shape::straight,
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "T = -m g e sin(theta + phi)",
    sentence: "The load is heavier on one side: gravity pulls it back and forth once per turn.",
};

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let (sin, cos) = (sights[0] + p[1]).sin_cos();
    shape::response(-p[0] * sin, &[-p[0] * cos], &[-sin, -p[0] * cos])
}
