//! A sensor that picks up the mains.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Sight, shape};

/// reading = truth + amplitude sin(2 pi frequency time + phase), time counted from where the recording began.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_hum",
    acts_at: ActsAt::Channel,
    parameters: &[
        EffectParameter::new("amplitude", Kind::Gain, POSITIVE),
        EffectParameter::new("frequency", Kind::Frequency, POSITIVE),
        EffectParameter { name: "phase", kind: Kind::Phase, default: Some((0.0, 0.0)), bounds: ANY },
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Time],
        acts: Acts::Reading,
        answer: |sights, p| {
            shape::wave(p[0], std::f64::consts::TAU * p[1], p[2], sights[0], std::f64::consts::TAU)
        },
        bend: shape::straight,
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "y = y_true + A sin(2 pi f t + phi)",
    sentence: "A sensor hums: mains pick-up, a ground loop, a converter's switching.",
};
