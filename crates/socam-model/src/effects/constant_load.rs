//! A constant torque from outside: weight, belt pull, the offset of a drive.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family,
        Form, Law, Linearisation, Places, Prior, QuantityKind, Rule, Steady, all_zero, begin_with_little,
    },
    experiment, shape, usual,
};

/// T = -torque: a positive value opposes positive motion.
pub const EFFECT: Effect = Effect {
    id: "constant_load",
    name: "constant load",
    acts_at: ActsAt::Node,
    family: Family::Load,
    places: Places::Load,
    parameters: &[EffectParameter::new("torque", QuantityKind::Torque, ANY)],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[],
        acts: Acts::Torque,
        rule: Rule::Code(|_, parameters| shape::response(-parameters[0], &[], &[-1.0])),
        formula: "-torque",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["torque"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["torque"]),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        vec![(
            "torque",
            Prior::within(rig.node(place).torque, "a constant pull is below the torque that moves the axis"),
        )]
    },
    discrepancy: &[Discrepancy::amplitude("torque")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[
        Equivalent { effect: "coulomb_friction", holds: Condition::OneDirection },
        Equivalent { effect: "direction_dependence", holds: Condition::OneDirection },
    ],
    steady: Steady::Linear,
    equation: "T = -T_0",
    sentence: |_| "A constant pull acts on the load: its weight, a belt, or an offset of the drive.",
    shows: "everywhere",
    experiment: experiment::THROUGH_STANDSTILL,
};
