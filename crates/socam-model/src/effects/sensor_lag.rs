//! A sensor that follows slowly.

use super::{ActsAt, Effect, EffectParameter, Form, Kind, POSITIVE};

/// time_constant reading' + reading = truth.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_lag",
    acts_at: ActsAt::Channel,
    parameters: &[EffectParameter::new("time_constant", Kind::Time, POSITIVE)],
    borrows: None,
    form: Form::Lag,
    equation: "tau y' + y = y_true",
    sentence: "A sensor follows slowly: a filter in its amplifier, or a tachometer's ripple filter.",
};
