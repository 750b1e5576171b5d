//! Play in a gear.

use super::{
    Acts, ActsAt, Borrowed, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, shape,
};
use crate::model::{CONTACT_DAMPING, MESH_DAMPING, MESH_STIFFNESS};

/// The mesh's contact carries nothing within the gap: beside a stiff spring and damper at the mesh acts what takes their torque
/// back there. Corners are rounded over what the spring gives under 0.01 N m. The contact's damping says how a knock rebounds: hardly
/// at all at its usual value, the more the less it is.
pub(super) const EFFECT: Effect = Effect {
    id: "backlash",
    acts_at: ActsAt::Gear,
    parameters: &[
        EffectParameter::new("gap", Kind::Angle, POSITIVE),
        EffectParameter::usual(CONTACT_DAMPING, Kind::Damping, (MESH_DAMPING, MESH_DAMPING)),
    ],
    borrows: Some(Borrowed::Contact),
    form: Form::Laws(&[Law {
        sights: &[Sight::Twist, Sight::TwistRate],
        acts: Acts::Torque,
        answer,
        bend: |parameters| 0.5 * parameters[0],
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "no torque while |play| < gap/2",
    sentence: "The mesh has play: when the torque changes sign, the output is let go for a moment and then knocks.",
};

/// Of the rounded corners, rad.
const ROUNDING: f64 = 0.01 / MESH_STIFFNESS;

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let (rate, stiffness, damping) = (sights[1], p[2], p[3]);
    let inside = shape::clip(sights[0], 0.5 * p[0], ROUNDING);
    shape::response(
        -stiffness * inside.value - damping * rate * inside.by_x,
        &[-stiffness * inside.by_x - damping * rate * inside.by_x_x, -damping * inside.by_x],
        &[
            -0.5 * (stiffness * inside.by_half + damping * rate * inside.by_x_half),
            0.0,
            -inside.value,
            -rate * inside.by_x,
        ],
    )
}
