//! A torque from outside that never changes: weight, belt pull, the offset of a drive.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, shape};

/// T = -torque: positive values load the node against positive motion.
pub(super) const EFFECT: Effect = Effect {
    id: "constant_load",
    acts_at: ActsAt::Node,
    parameters: &[EffectParameter::new("torque", Kind::Torque, ANY)],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[],
        acts: Acts::Torque,
        answer: |_, parameters| shape::response(-parameters[0], &[], &[-1.0]),
        bend: shape::straight,
        silent: |parameters| parameters[0] == 0.0,
    }]),
    equation: "T = -T_0",
    sentence: "A constant pull acts on the load: its weight, a belt, or an offset of the drive.",
};
