//! Inertia that nobody counted.

use super::{ANY, ActsAt, Effect, EffectParameter, Form, Kind};

/// More inertia at a node (less, where it is negative: then the drawing's value is too large).
pub(super) const EFFECT: Effect = Effect {
    id: "missing_inertia",
    acts_at: ActsAt::Node,
    parameters: &[EffectParameter::new("inertia", Kind::Inertia, ANY)],
    borrows: None,
    form: Form::Inertia,
    equation: "J = J_0 + dJ",
    sentence: "Something turns along that was not counted: a hub, a coupling half, a fixture.",
};
