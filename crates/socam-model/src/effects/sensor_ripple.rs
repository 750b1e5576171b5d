//! A sensor that swings with the angle of its shaft.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Sight, shape};

/// reading = truth + amplitude sin(order angle + phase), the angle counted from where the recording began.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_ripple",
    acts_at: ActsAt::Channel,
    parameters: &[
        EffectParameter::new("amplitude", Kind::Gain, POSITIVE),
        EffectParameter::new("order", Kind::Ratio, POSITIVE),
        EffectParameter { name: "phase", kind: Kind::Phase, default: Some((0.0, 0.0)), bounds: ANY },
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Angle],
        acts: Acts::Reading,
        answer: |sights, p| shape::wave(p[0], p[1], p[2], sights[0], 1.0),
        bend: shape::straight,
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "y = y_true + A sin(n theta + phi)",
    sentence: "A sensor swings as its shaft turns: a tachometer's commutator, a bent coupling, a magnet off centre.",
};
