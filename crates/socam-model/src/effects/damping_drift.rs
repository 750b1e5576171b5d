//! A bearing's viscous damping that changes while it runs.

use super::{ANY, Acts, ActsAt, Borrowed, Effect, EffectParameter, Form, Kind, Law, Response, Sight, shape};

/// T = -damping rate time speed, beside the bearing's own -damping speed.
pub(super) const EFFECT: Effect = Effect {
    id: "damping_drift",
    acts_at: ActsAt::Bearing,
    parameters: &[EffectParameter::new("rate", Kind::Rate, ANY)],
    borrows: Some(Borrowed::Damping),
    form: Form::Laws(&[Law {
        sights: &[Sight::Speed, Sight::Time],
        acts: Acts::Torque,
        answer,
        bend: shape::straight,
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "c = c_0 (1 + r t)",
    sentence: "The drag changes while the bench runs: grease that warms up, or a brake that fades.",
};

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let (speed, time) = (sights[0], sights[1]);
    let (rate, damping) = (p[0], p[1]);
    shape::response(
        -damping * rate * time * speed,
        &[-damping * rate * time, -damping * rate * speed],
        &[-damping * time * speed, -rate * time * speed],
    )
}
