//! Feetech servos of the STS and SMS series.
//!
//! Registers, signs and units are those of the manufacturer's memory tables and of its library FTServo_Arduino (`SMS_STS`): numbers are
//! little-endian, with a sign and a magnitude. Servos of the SCS series store them the other way round, and are refused.

mod packet;

use std::f64::consts::TAU;

use socam_units::Unit;

use crate::ZERO_CELSIUS_K;
use crate::error::Result;
use crate::servos::{Facts, Make, Quantity, Servos};

/// First register that is read once, and registers by their place behind it.
const FIRST: u16 = 2;
const BYTE_ORDER: usize = 0;
const MODEL: usize = 1;
const LOWEST: usize = 7;
const HIGHEST: usize = 9;
const PHASE: usize = 16;
const RESOLUTION: usize = 28;
const OFFSET: usize = 29;
const MODE: usize = 31;

/// Bits of the phase: the speed is in steps a second, not in 50 of them; there is no measure of current.
const FINE_SPEED: u8 = 0x04;
const NO_CURRENT: u8 = 0x20;
/// The mode in which the position is the way that is left.
const STEP_MODE: u8 = 3;
/// Models whose registers are known to be these: STS3215, STS3250, SM8512BL.
const KNOWN: [u16; 3] = [777, 2825, 11272];

const STEP_RAD: f64 = TAU / 4096.0;
const CURRENT_A: f64 = 6.5e-3;
/// What the bits of an answer's error mean.
const FAULTS: [(u8, &str); 6] = [
    (0x01, "a supply that is too high or too low"),
    (0x02, "a fault of its encoder"),
    (0x04, "too high a temperature"),
    (0x08, "too high a current"),
    (0x10, "an angle beyond its limits"),
    (0x20, "overload"),
];

const MAKE: Make = Make {
    name: "Feetech",
    address: "feetech:/dev/ttyACM0?id=1",
    largest_id: 253,
    facts: (FIRST, 32),
    // Position, speed, load, voltage, temperature and current with what lies between them.
    sample: (56, 15),
    quantities: &[
        Quantity::new("position", Unit::Rad, 0.0),
        Quantity::new("speed", Unit::RadPerS, 0.0),
        Quantity::new("load", Unit::One, 0.0),
        Quantity::new("current", Unit::A, 0.0),
        Quantity::new("voltage", Unit::V, 0.0),
        Quantity::new("temperature", Unit::K, ZERO_CELSIUS_K),
    ],
    question: packet::question,
    packet: packet::take,
    learn,
    numbers,
    refusal: 0,
    fault,
};

/// Servos of these numbers (0 to 253) on one bus, asked at this interval.
///
/// # Errors
/// When no servo has such a number, a number stands twice, or there are too many.
pub fn servos(ids: &[u8], period_ns: i64) -> Result<Servos> {
    Servos::new(&MAKE, ids, period_ns)
}

fn fault(error: u8) -> String {
    let words: Vec<&str> =
        FAULTS.iter().filter(|(bit, _)| error & bit != 0).map(|(_, words)| *words).collect();
    if words.is_empty() { format!("an error of the code {error}") } else { words.join(", ") }
}

fn word(registers: &[u8], at: usize) -> u16 {
    let bytes = registers.get(at..at + 2).and_then(|bytes| <[u8; 2]>::try_from(bytes).ok());
    bytes.map(u16::from_le_bytes).unwrap_or_default()
}

/// A number with its sign in a bit.
fn signed(number: u16, sign: u16) -> f64 {
    let magnitude = f64::from(number & !sign);
    if number & sign != 0 { -magnitude } else { magnitude }
}

fn learn(registers: &[u8]) -> std::result::Result<Facts, String> {
    let byte = |at: usize| registers.get(at).copied().unwrap_or_default();
    if byte(BYTE_ORDER) != 0 {
        return Err("stores its numbers in the order of the SCS series; only servos of the STS and SMS series are read".into());
    }
    let (model, phase, resolution) = (word(registers, MODEL), byte(PHASE), byte(RESOLUTION).max(1));
    let speed_steps = if phase & FINE_SPEED != 0 { 1.0 } else { 50.0 };
    let position_rad = if byte(MODE) == STEP_MODE { f64::NAN } else { STEP_RAD * f64::from(resolution) };
    let current_a = if phase & NO_CURRENT != 0 { f64::NAN } else { CURRENT_A };
    let mut words = format!(
        "model {model}; its homing offset is {}, its positions go from {} to {}, its speed counts {speed_steps} steps a second",
        signed(word(registers, OFFSET), 1 << 11),
        word(registers, LOWEST),
        word(registers, HIGHEST)
    );
    if !KNOWN.contains(&model) {
        words += "; this model is not known, and read as an STS3215";
    }
    if position_rad.is_nan() {
        words += "; it is in its step mode, so that its position is not known";
    }
    if current_a.is_nan() {
        words += "; it measures no current";
    }
    let factors = vec![position_rad, STEP_RAD * speed_steps, 1e-3, current_a, 0.1, 1.0];
    Ok(Facts { factors, words })
}

fn numbers(values: &[u8]) -> Option<Vec<f64>> {
    let (voltage, celsius) = (values.get(6)?, values.get(7)?);
    Some(vec![
        signed(word(values, 0), 1 << 15),
        signed(word(values, 2), 1 << 15),
        signed(word(values, 4), 1 << 10),
        signed(word(values, 13), 1 << 15),
        f64::from(*voltage),
        f64::from(*celsius),
    ])
}
