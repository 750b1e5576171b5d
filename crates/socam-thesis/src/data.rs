//! The thesis' numbers as `thesis.toml` has them.
#![expect(
    missing_docs,
    reason = "each field is named as in thesis.toml, which says the place in the thesis; units are in the names"
)]

use serde::Deserialize;

use crate::Printed;

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thesis {
    pub hardware: Hardware,
    pub motor: Motor,
    pub couplings: Couplings,
    pub inertia: Inertia,
    pub transfer: Transfer,
    pub matching: Matching,
    pub efficiency: Efficiency,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(non_snake_case, reason = "units as they are written")]
pub struct Hardware {
    pub converter_bits: Printed,
    pub converter_range_V: Printed,
    pub ratio: Printed,
    pub input_tachometer_V_per_krpm: Printed,
    pub output_tachometer_V_per_krpm: Printed,
    pub input_torque_sensor_mV_per_Nm: Printed,
    pub output_torque_sensor_mV_per_Nm: Printed,
    pub calibration_loaded: [Printed; 2],
    pub calibration_free: [Printed; 2],
    pub recording_s: Printed,
    pub recording_step_ms: Printed,
    pub recording_rows: Printed,
    pub program_step_ms: Printed,
    pub program_rows: [Printed; 2],
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(non_snake_case, reason = "units as they are written")]
pub struct Motor {
    pub voltage_V: Printed,
    pub current_A: Printed,
    pub speed_rpm: Printed,
    pub efficiency_percent: Printed,
    pub damping_Nm_per_rpm: Printed,
    pub inertia_Nms2: Printed,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(non_snake_case, reason = "units as they are written")]
pub struct Couplings {
    pub catalogue_Nm_per_deg: [Printed; 3],
    pub measured_Nm_per_deg: [Printed; 3],
    pub identified_Nm_per_deg: [Printed; 3],
    pub errors_percent: [Printed; 3],
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inertia {
    pub cam_shaft_kgmm2: Printed,
    pub disk_kgmm2: Printed,
    pub load_kgmm2: Printed,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transfer {
    pub numerator: [Printed; 6],
    pub denominator: [Printed; 7],
    pub final_value: Printed,
    pub factors: [[Printed; 2]; 3],
    pub natural_frequencies_hz: [Printed; 3],
    pub damping_ratios: [Printed; 3],
    pub economised_4: [Printed; 5],
    pub economised_3: [Printed; 4],
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(non_snake_case, reason = "units as they are written")]
pub struct Matching {
    pub torque_Nmm: Printed,
    pub speed_deg_s: Printed,
    pub time_constant_s: Printed,
    pub motor_inertia: Printed,
    pub k_char: Printed,
    pub c_char: Printed,
    pub right_sides: [Printed; 10],
    pub constants: [Printed; 10],
    pub initial: [Printed; 8],
    pub weights_1: [Printed; 10],
    pub solution_1: [Printed; 8],
    pub minimum_1: Printed,
    pub gradient_1: [Printed; 8],
    pub parameters_1: [Printed; 8],
    pub weights_2: [Printed; 10],
    pub solution_2: [Printed; 8],
    pub minimum_2: Printed,
    pub parameters_2: [Printed; 8],
    pub coefficients: Vec<Coefficient>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coefficient {
    pub equation: String,
    pub term: String,
    pub value: Printed,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Efficiency {
    pub system: [[Printed; 6]; 3],
    pub coupling_1: [[Printed; 6]; 3],
    pub coupling_2: [[Printed; 6]; 3],
    pub reducer_percent: [Printed; 3],
}

/// The embedded data.
///
/// # Errors
/// When they cannot be read; one sentence.
pub fn thesis() -> Result<Thesis, String> {
    toml::from_str(include_str!("thesis.toml"))
        .map_err(|error| format!("the thesis' data cannot be read: {error}"))
}
