//! Meanings of the effects' parameters: the source of the table of docs/model-file.md, with which a test compares it.

use super::{
    catalogue::{CATALOGUE, REFINED},
    definition::{Effect, EffectParameter},
};

/// Parameters that mean the same in every effect: name, meaning.
const COMMON: &[(&str, &str)] = &[
    ("transition_speed", "speed within which the sign of a speed is smoothed"),
    ("transition_torque", "torque within which the sign of a torque is smoothed"),
    ("contact_damping", "damping of the contact where teeth touch"),
    ("phase", "phase of the wave at angle 0, or at the start of the recording for a wave over time"),
];

/// Parameters of one effect: effect id, name, meaning.
const MEANINGS: &[(&str, &str, &str)] = &[
    ("coulomb_friction", "torque", "friction torque, the same at any speed"),
    ("coulomb_friction", "deflection", "deflection after which 63 % of the friction torque is reached"),
    ("stribeck_friction", "torque", "friction torque at high speed"),
    ("stribeck_friction", "static_torque", "friction torque at standstill"),
    (
        "stribeck_friction",
        "stribeck_speed",
        "speed over which the friction torque falls from `static_torque` to `torque`",
    ),
    ("stribeck_friction", "deflection", "deflection after which 63 % of the static torque is reached"),
    ("quadratic_drag", "coefficient", "drag torque divided by speed squared"),
    (
        "damping_drift",
        "rate",
        "relative change of the bearing's damping per second from the recording's start",
    ),
    ("direction_dependence", "torque_difference", "drag torque forward minus backward"),
    ("direction_dependence", "damping_difference", "damping forward minus backward"),
    ("constant_load", "torque", "torque against positive motion"),
    ("mesh_loss", "fraction", "share of the torque entering the mesh that is lost"),
    ("mesh_loss", "deflection", "angle of the slow side after which 63 % of the loss is reached"),
    ("mesh_loss", "back_fraction", "that share while the slow side drives, where it differs from `fraction`"),
    ("backlash", "gap", "total play between the flanks, at the to node"),
    ("kinematic_error", "order", "cycles per turn of the from node"),
    ("kinematic_error", "amplitude", "amplitude of the angle error, at the to node"),
    ("stiffness_hardening", "cubic", "a in T = k d (1 + a d2); negative where it softens"),
    ("hysteresis", "torque", "limit of the torque of the inner friction"),
    ("hysteresis", "deflection", "twist after which 63 % of that limit is reached"),
    ("missing_compliance", "stiffness", "stiffness of the shaft"),
    ("missing_compliance", "damping", "damping of the shaft"),
    ("missing_inertia", "inertia", "inertia that is added to that of the node"),
    ("mounting_compliance", "stiffness", "stiffness of what holds the frame"),
    ("mounting_compliance", "frequency", "natural frequency of the frame without the machine"),
    ("mounting_compliance", "damping_ratio", "damping ratio of the frame"),
    ("coupling_slip", "torque", "torque at which the coupling slips"),
    ("gravity_unbalance", "torque", "weight times its distance from the axis"),
    ("external_disturbance", "torque", "amplitude of the torque"),
    ("external_disturbance", "frequency", "frequency of the torque"),
    ("torque_ripple", "order", "cycles per turn of the node"),
    ("torque_ripple", "torque", "amplitude of the torque"),
    ("sensor_gain", "gain", "reading divided by truth"),
    ("sensor_offset", "offset", "reading at zero"),
    ("sensor_lag", "time_constant", "time constant of a first-order filter"),
    ("sensor_delay", "delay", "time by which the reading is late"),
    ("sensor_saturation", "limit", "largest magnitude that the channel can read"),
    (
        "sensor_saturation",
        "excess",
        "mean excess of the true input over the limit while the input reads the limit",
    ),
    ("drive_limit", "limit", "largest magnitude of the input that acts on the machine"),
    (
        "sensor_fold",
        "share",
        "share of the truth that is read without its sign; at 1 the reading is the magnitude",
    ),
    ("direction_gain", "difference", "gain of positive values minus gain of negative values"),
    ("velocity_weakening", "torque", "torque by which friction at standstill exceeds that at speed"),
    ("velocity_weakening", "fall_speed", "speed at which that excess has fallen by a factor of e"),
    ("sensor_hum", "amplitude", "amplitude of the wave"),
    ("sensor_hum", "frequency", "frequency of the wave"),
    ("sensor_ripple", "amplitude", "amplitude of the wave"),
    ("sensor_ripple", "order", "cycles per turn of the channel's shaft"),
];

/// Meaning of a parameter of an effect, without a final dot; empty for an unknown one.
pub(crate) fn meaning(effect: &str, parameter: &str) -> &'static str {
    let own = MEANINGS.iter().find(|(id, name, _)| *id == effect && *name == parameter);
    let common = || COMMON.iter().find(|(name, _)| *name == parameter).map(|(_, text)| *text);
    own.map(|(.., text)| *text).or_else(common).unwrap_or_default()
}

/// All parameters that a model file may give for an effect, each with whether it must be given. Parameters of refined laws come last.
pub(crate) fn parameters_of(effect: &Effect) -> Vec<(&'static EffectParameter, bool)> {
    let mut all: Vec<(&EffectParameter, bool)> = Vec::new();
    let laws = CATALOGUE.iter().map(|law| (law, true)).chain(REFINED.iter().map(|law| (law, false)));
    for (law, is_plain) in laws.filter(|(law, _)| law.id == effect.id) {
        for parameter in law.parameters {
            if !all.iter().any(|(known, _)| known.name == parameter.name) {
                all.push((parameter, is_plain && parameter.default.is_none()));
            }
        }
    }
    all
}
