//! A torque from outside that swings at a frequency of its own.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Sight, shape};

/// T = torque sin(2 pi frequency time + phase), time counted from where the recording began.
pub(super) const EFFECT: Effect = Effect {
    id: "external_disturbance",
    acts_at: ActsAt::Node,
    parameters: &[
        EffectParameter::new("torque", Kind::Torque, POSITIVE),
        EffectParameter::new("frequency", Kind::Frequency, POSITIVE),
        EffectParameter::new("phase", Kind::Phase, ANY),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Time],
        acts: Acts::Torque,
        answer: |sights, p| {
            shape::wave(p[0], std::f64::consts::TAU * p[1], p[2], sights[0], std::f64::consts::TAU)
        },
        bend: shape::straight,
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "T = T_0 sin(2 pi f t + phi)",
    sentence: "Something shakes the load at a frequency of its own: a machine next to the bench, a pulsating pump.",
};
