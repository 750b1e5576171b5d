//! A reduction that does not roll true.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, shape};

/// The slow side is ahead by amplitude sin(order angle of the fast side + phase): a torque on a stiff spring at the mesh
/// that it takes to twist it by so much.
pub(super) const EFFECT: Effect = Effect {
    id: "kinematic_error",
    acts_at: ActsAt::Gear,
    parameters: &[
        EffectParameter::new("order", Kind::Ratio, POSITIVE),
        EffectParameter::new("amplitude", Kind::Angle, POSITIVE),
        EffectParameter::new("phase", Kind::Phase, ANY),
    ],
    borrows: Some(super::Borrowed::Stiffness),
    form: Form::Laws(&[Law {
        sights: &[Sight::Angle],
        acts: Acts::Torque,
        answer,
        bend: shape::straight,
        silent: |parameters| parameters[1] == 0.0,
    }]),
    equation: "theta_out = theta_in / N + A sin(n theta_in + phi)",
    sentence: "The reduction does not roll true: an eccentric cam, an indexing error of the rollers, once or more per turn.",
};

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let (sin, cos) = (p[0] * sights[0] + p[2]).sin_cos();
    let (amplitude, stiffness) = (p[1], p[3]);
    let size = stiffness * amplitude;
    shape::response(
        size * sin,
        &[size * p[0] * cos],
        &[size * sights[0] * cos, stiffness * sin, size * cos, amplitude * sin],
    )
}
