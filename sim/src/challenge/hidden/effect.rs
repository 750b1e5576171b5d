//! The effects that can be hidden.

use serde::{Deserialize, Serialize};

/// A hidden effect with its parameters, SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    /// Id of the effect in the catalogue, or the name of a kind outside of it.
    pub effect: String,
    /// Place or channel.
    pub place: String,
    /// Parameters by the catalogue's names.
    pub parameters: Vec<(String, f64)>,
    /// Further parameters of the truth's own law.
    pub own: Vec<f64>,
}

/// Effects of the catalogue that may be hidden.
pub(crate) const NAMED: [&str; 24] = [
    "coulomb_friction",
    "stribeck_friction",
    "quadratic_drag",
    "damping_drift",
    "direction_dependence",
    "constant_load",
    "mesh_loss",
    "backlash",
    "kinematic_error",
    "stiffness_hardening",
    "hysteresis",
    "missing_compliance",
    "missing_inertia",
    "coupling_slip",
    "gravity_unbalance",
    "external_disturbance",
    "torque_ripple",
    "sensor_gain",
    "sensor_offset",
    "sensor_lag",
    "sensor_delay",
    "sensor_saturation",
    "sensor_hum",
    "sensor_ripple",
];

/// Effects outside the catalogue.
pub(crate) const OUTSIDE: [&str; 7] =
    ["eddy_current_brake", "late_pad", "angle_play", "angle_drag", "loosening", "gain_drift", "wearing_in"];
