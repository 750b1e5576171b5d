//! A sensor that reports late.

use super::{ActsAt, Effect, EffectParameter, Form, Kind, POSITIVE};

/// reading(t) = truth(t - delay), by two all-pass sections of second order each (Padé): within a thousandth up to
/// frequency x delay = 0.4.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_delay",
    acts_at: ActsAt::Channel,
    parameters: &[EffectParameter::new("delay", Kind::Time, POSITIVE)],
    borrows: None,
    form: Form::Delay,
    equation: "y(t) = y_true(t - d)",
    sentence: "A sensor reports late: a digital filter, a bus, a converter that is read in turn.",
};
