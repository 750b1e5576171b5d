//! A sensor that reads too much or too little.

use super::{ActsAt, Effect, EffectParameter, Form, Kind};

/// reading = gain truth: 0.98 reads 2 % low.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_gain",
    acts_at: ActsAt::Channel,
    parameters: &[EffectParameter::new("gain", Kind::Ratio, (0.01, 100.0))],
    borrows: None,
    form: Form::Gain,
    equation: "y = g y_true",
    sentence: "A sensor reads a fixed share too much or too little: its calibration is off.",
};
