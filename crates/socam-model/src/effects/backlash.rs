//! Play in a gear.

use super::{
    Acts, ActsAt, Borrowed, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, shape,
};
use crate::model::MESH_STIFFNESS;

/// The mesh's contact carries nothing within the gap: beside a stiff spring and damper at the mesh acts what takes their torque
/// back there. Corners are rounded over what the spring gives under 1 N m.
pub(super) const EFFECT: Effect = Effect {
    id: "backlash",
    acts_at: ActsAt::Gear,
    parameters: &[EffectParameter::new("gap", Kind::Angle, POSITIVE)],
    borrows: Some(Borrowed::Contact),
    form: Form::Laws(&[Law {
        sights: &[Sight::Twist, Sight::TwistRate],
        acts: Acts::Torque,
        answer,
        bend: |parameters| 0.5 * parameters[0],
    }]),
    equation: "no torque while |play| < gap/2",
    sentence: "The mesh has play: when the torque changes sign, the output is let go for a moment and then knocks.",
};

/// Of the rounded corners, rad.
const ROUNDING: f64 = 1.0 / MESH_STIFFNESS;

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let (rate, stiffness, damping) = (sights[1], p[1], p[2]);
    let inside = shape::clip(sights[0], 0.5 * p[0], ROUNDING);
    shape::response(
        -stiffness * inside.value - damping * rate * inside.by_x,
        &[-stiffness * inside.by_x - damping * rate * inside.by_x_x, -damping * inside.by_x],
        &[
            -0.5 * (stiffness * inside.by_half + damping * rate * inside.by_x_half),
            -inside.value,
            -rate * inside.by_x,
        ],
    )
}
