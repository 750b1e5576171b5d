//! Dynamixel servos of the X series by their protocol 2.
//!
//! Registers and units are those of the manufacturer's e-Manual (emanual.robotis.com/docs/en/dxl/x).

mod packet;

use std::f64::consts::TAU;

use socam_units::Unit;

use crate::ZERO_CELSIUS_K;
use crate::error::Result;
use crate::servos::{Facts, Make, Quantity, Servos};

/// Positions in a turn, and the unit of speeds, rpm.
const POSITIONS: f64 = 4096.0;
const SPEED_RPM: f64 = 0.229;
/// Bit of the error of an answer that says that its register of hardware errors holds one.
const ALERT: u8 = 0x80;
/// The unit of the measured current by number of the model, A. Servos that are not here state a load without a unit there, or another unit.
const CURRENTS: [(u16, f64); 14] = [
    (311, 3.36e-3),
    (321, 3.36e-3),
    (1000, 2.69e-3),
    (1010, 2.69e-3),
    (1020, 2.69e-3),
    (1030, 2.69e-3),
    (1040, 2.69e-3),
    (1050, 2.69e-3),
    (1100, 2.69e-3),
    (1110, 2.69e-3),
    (1120, 2.69e-3),
    (1130, 2.69e-3),
    (1190, 1e-3),
    (1200, 1e-3),
];

const MAKE: Make = Make {
    name: "Dynamixel",
    address: "dynamixel:/dev/ttyUSB0?id=1",
    largest_id: 252,
    // The model, and settings up to the limits of the position.
    facts: (0, 56),
    // Current, speed, position, voltage and temperature with what lies between them.
    sample: (126, 21),
    quantities: &[
        Quantity::new("position", Unit::Rad, 0.0),
        Quantity::new("speed", Unit::RadPerS, 0.0),
        Quantity::new("current", Unit::A, 0.0),
        Quantity::new("voltage", Unit::V, 0.0),
        Quantity::new("temperature", Unit::K, ZERO_CELSIUS_K),
    ],
    question: packet::question,
    packet: packet::take,
    learn,
    numbers,
    refusal: !ALERT,
    fault: |_| "a hardware error, which its register 70 names".into(),
};

/// Servos of these numbers (0 to 252) on one bus, asked at this interval.
///
/// # Errors
/// When no servo has such a number, a number stands twice, or there are too many.
pub fn servos(ids: &[u8], period_ns: i64) -> Result<Servos> {
    Servos::new(&MAKE, ids, period_ns)
}

/// The unit of the current of a model, A.
fn current_a(model: u16) -> Option<f64> {
    CURRENTS.iter().find(|(known, _)| *known == model).map(|(_, unit_a)| *unit_a)
}

fn learn(registers: &[u8]) -> std::result::Result<Facts, String> {
    let bytes = |at: usize| registers.get(at..at + 4).and_then(|bytes| <[u8; 4]>::try_from(bytes).ok());
    let number = |at: usize| bytes(at).map(i32::from_le_bytes).unwrap_or_default();
    let model = (number(0) & 0xffff) as u16;
    let current_a = current_a(model);
    let left_out =
        if current_a.is_none() { ", whose measure of current has no known unit and is left out" } else { "" };
    let words = format!(
        "model {model}{left_out}; its homing offset is {}, its positions go from {} to {}",
        number(20),
        number(52),
        number(48)
    );
    let factors = vec![TAU / POSITIONS, SPEED_RPM * TAU / 60.0, current_a.unwrap_or(f64::NAN), 0.1, 1.0];
    Ok(Facts { factors, words })
}

fn numbers(values: &[u8]) -> Option<Vec<f64>> {
    let [i0, i1, v0, v1, v2, v3, p0, p1, p2, p3, .., u0, u1, celsius] = *values else { return None };
    Some(vec![
        f64::from(i32::from_le_bytes([p0, p1, p2, p3])),
        f64::from(i32::from_le_bytes([v0, v1, v2, v3])),
        f64::from(i16::from_le_bytes([i0, i1])),
        f64::from(u16::from_le_bytes([u0, u1])),
        f64::from(celsius),
    ])
}
