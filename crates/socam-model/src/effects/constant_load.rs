//! A torque from outside that never changes: weight, belt pull, the offset of a drive.

use super::{ActsAt, Effect, EffectParameter, Kind, Response};

/// T = -torque: positive values load the node against positive motion.
pub(super) const EFFECT: Effect = Effect {
    id: "constant_load",
    acts_at: ActsAt::Node,
    parameters: &[EffectParameter { name: "torque", kind: Kind::Torque, default: None }],
    equation: "T = -T_0",
    sentence: "A constant pull acts on the load: its weight, a belt, or an offset of the drive.",
    law: |_, parameters| Response {
        torque: -parameters[0],
        slope_speed: 0.0,
        slope_parameters: [-1.0, 0.0, 0.0, 0.0],
    },
    transition_speed: |_| 0.0,
};
