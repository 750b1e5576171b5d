//! A sensor whose zero is off.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, shape};

/// reading = truth + offset.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_offset",
    acts_at: ActsAt::Channel,
    parameters: &[EffectParameter::new("offset", Kind::Gain, ANY)],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[],
        acts: Acts::Reading,
        answer: |_, parameters| shape::response(parameters[0], &[], &[1.0]),
        bend: shape::straight,
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "y = y_true + o",
    sentence: "A sensor does not read zero at zero: its zero has drifted, or was never set.",
};
