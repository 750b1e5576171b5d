//! A shaft that was taken to be rigid and is not.

use super::{ActsAt, Effect, EffectParameter, Form, Kind, POSITIVE};

/// A spring and damper in the shaft's place.
pub(super) const EFFECT: Effect = Effect {
    id: "missing_compliance",
    acts_at: ActsAt::Shaft,
    parameters: &[
        EffectParameter::new("stiffness", Kind::Stiffness, POSITIVE),
        EffectParameter::new("damping", Kind::Damping, POSITIVE),
    ],
    borrows: None,
    form: Form::Compliance,
    equation: "T = k d + c d'",
    sentence: "A shaft that was taken to be rigid twists: a thin section, a key, a clamp that gives.",
};
