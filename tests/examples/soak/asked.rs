//! Drives and servos that are asked: each position that they state is the number of the question.

use std::f64::consts::TAU;
use std::time::Duration;

use socam_sources::simulators::{
    BusSimulator, CanopenSimulator, DynamixelSimulator, FeetechSimulator, Firmware, MoteusSimulator, Motor,
    OdriveCanSimulator, OdriveSimulator,
};

/// Bits per byte and rate of the line of servos, 1/s.
const BITS: f64 = 10.0;
const SERVO_BAUD: f64 = 1e6;

enum Drive {
    Moteus(MoteusSimulator),
    Odrive(OdriveSimulator),
    OdriveCan(BusSimulator<OdriveCanSimulator>),
    Canopen(BusSimulator<CanopenSimulator>),
    Dynamixels(Vec<DynamixelSimulator>),
    Feetechs(Vec<FeetechSimulator>),
}

/// A drive that numbers its answers.
pub(crate) struct Asked {
    drive: Drive,
    next: u64,
}

impl Asked {
    pub(crate) fn new(name: &str, next: u64) -> Self {
        let motor = Motor::turning(0.0, 0.25, 24.0);
        // A speed of one count a second: a servo's position is its time.
        let servo = Motor::turning(TAU / 4096.0, 0.25, 12.0);
        let drive = match name {
            "moteus" => Drive::Moteus(MoteusSimulator::new(1, motor)),
            "odrive" => Drive::Odrive(OdriveSimulator::new(Firmware::Late, motor)),
            "odrive_can" => {
                Drive::OdriveCan(BusSimulator::new(OdriveCanSimulator::new(1, Firmware::Late, motor)))
            }
            "canopen" => Drive::Canopen(BusSimulator::new(CanopenSimulator::new(5, motor))),
            "dynamixel" => {
                Drive::Dynamixels((1..=6).map(|id| DynamixelSimulator::new(id, 1020, servo)).collect())
            }
            _ => Drive::Feetechs((1..=6).map(|id| FeetechSimulator::new(id, servo)).collect()),
        };
        Self { drive, next }
    }

    /// Number of the next answer.
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// Takes bytes at a time, s, and returns the answers.
    pub(crate) fn receive(&mut self, time_s: f64, bytes: &[u8]) -> Vec<u8> {
        let number = self.next as f64;
        let has = |what: &[u8]| bytes.windows(what.len()).any(|window| window == what);
        let (answer, is_row) = match &mut self.drive {
            Drive::Moteus(drive) => {
                drive.motor.angle_rad = number * TAU;
                (drive.receive(time_s, bytes), has(b"can send"))
            }
            Drive::Odrive(drive) => {
                drive.motor.angle_rad = number * TAU;
                (drive.receive(time_s, bytes), has(b"f 0"))
            }
            Drive::OdriveCan(bus) => {
                bus.node.motor.angle_rad = number * TAU;
                (bus.receive(time_s, bytes), has(b"r029"))
            }
            Drive::Canopen(bus) => {
                // Half a count more, so that rounding down gives it.
                bus.node.motor.angle_rad = (number + 0.5) * TAU / 4096.0;
                (bus.receive(time_s, bytes), has(b"40646000"))
            }
            Drive::Dynamixels(servos) => {
                on_line(bytes, servos.iter_mut().flat_map(|servo| servo.receive(number, bytes)).collect())
            }
            Drive::Feetechs(servos) => {
                on_line(bytes, servos.iter_mut().flat_map(|servo| servo.receive(number, bytes)).collect())
            }
        };
        self.next += u64::from(is_row);
        answer
    }
}

/// An answer that takes the time of its bytes and those of its question.
fn on_line(question: &[u8], answer: Vec<u8>) -> (Vec<u8>, bool) {
    let bits = BITS * (question.len() + answer.len()) as f64;
    if !answer.is_empty() {
        std::thread::sleep(Duration::from_secs_f64(bits / SERVO_BAUD));
    }
    let is_row = !answer.is_empty();
    (answer, is_row)
}
