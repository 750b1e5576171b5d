//! Simulations of drives that answer questions as the real ones do, for tests and rehearsals. Their motors turn evenly.

use std::f64::consts::TAU;

use moteus_protocol::fdcanusb::{self, Line};
use moteus_protocol::{CanFdFrame, Register, Subframe, parse_arbitration_id, parse_frame};

/// The motor of a simulated drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// Speed, rad/s.
    pub speed_rad_s: f64,
    /// Torque, N m.
    pub torque_nm: f64,
    /// Current, A.
    pub current_a: f64,
    /// Supply, V.
    pub voltage_v: f64,
    /// Code of a fault, 0 without one.
    pub fault: u8,
}

/// A moteus behind an fdcanusb.
#[derive(Debug)]
pub struct MoteusSimulator {
    /// Number of the drive.
    pub id: u8,
    /// Its motor.
    pub motor: Turning,
    bytes: Vec<u8>,
}

/// An ODrive with the protocol of text of firmware 0.6.
#[derive(Debug)]
pub struct OdriveSimulator {
    /// The motor of its axis 0.
    pub motor: Turning,
    bytes: Vec<u8>,
}

/// Takes the whole lines out of bytes.
fn lines(bytes: &mut Vec<u8>, more: &[u8]) -> Vec<String> {
    bytes.extend_from_slice(more);
    let Some(end) = bytes.iter().rposition(|byte| *byte == b'\n') else { return Vec::new() };
    let whole: Vec<u8> = bytes.drain(..=end).collect();
    String::from_utf8_lossy(&whole).lines().map(str::to_owned).collect()
}

impl MoteusSimulator {
    /// A drive at rest until its motor is set.
    #[must_use]
    pub fn new(id: u8, motor: Turning) -> Self {
        Self { id, motor, bytes: Vec::new() }
    }

    /// Takes bytes at a time since it was switched on, s, and returns its answers.
    pub fn receive(&mut self, time_s: f64, bytes: &[u8]) -> Vec<u8> {
        let mut answers = Vec::new();
        for line in lines(&mut self.bytes, bytes) {
            let Some(sent) = line.strip_prefix("can send ") else {
                answers.extend_from_slice(b"ERR unknown command\r\n");
                continue;
            };
            answers.extend_from_slice(b"OK\r\n");
            // A frame that is sent is written like one that was received.
            let Line::Rcv(frame) = fdcanusb::parse_line(format!("rcv {sent}").as_bytes()) else { continue };
            let (_, to, _) = parse_arbitration_id(frame.arbitration_id);
            if to == self.id as i8 {
                answers.extend(self.answer(time_s, &frame));
            }
        }
        answers
    }

    /// The line with the registers that a frame asks for.
    fn answer(&self, time_s: f64, frame: &CanFdFrame) -> Vec<u8> {
        let mut data: Vec<u8> = Vec::new();
        for part in parse_frame(frame.payload()) {
            let Subframe::Register { register, value: None, .. } = part else { continue };
            let small = |value: u8| (0x21, vec![value]);
            let float = |value: f64| (0x2d, (value as f32).to_le_bytes().to_vec());
            let (head, value) = match Register::from_address(register) {
                Some(Register::Mode) => small(if self.motor.fault > 0 { 1 } else { 10 }),
                Some(Register::Position) => float(self.motor.speed_rad_s * time_s / TAU),
                Some(Register::Velocity) => float(self.motor.speed_rad_s / TAU),
                Some(Register::Torque) => float(self.motor.torque_nm),
                Some(Register::QCurrent) => float(self.motor.current_a),
                Some(Register::Voltage) => float(self.motor.voltage_v),
                Some(Register::Temperature) => float(35.0),
                Some(Register::Fault) => small(self.motor.fault),
                _ => continue,
            };
            data.push(head);
            data.push(register as u8);
            data.extend(value);
        }
        let digits: String = data.iter().map(|byte| format!("{byte:02X}")).collect();
        format!("rcv {:02x}00 {digits} E B F\r\n", self.id).into_bytes()
    }
}

impl OdriveSimulator {
    /// A drive whose axis 0 has this motor.
    #[must_use]
    pub fn new(motor: Turning) -> Self {
        Self { motor, bytes: Vec::new() }
    }

    /// Takes bytes at a time since it was switched on, s, and returns its answers.
    pub fn receive(&mut self, time_s: f64, bytes: &[u8]) -> Vec<u8> {
        let turns_s = self.motor.speed_rad_s / TAU;
        let answer = |line: String| match line.as_str() {
            "f 0" => format!("{:.6} {turns_s:.6}\r\n", turns_s * time_s),
            "r axis0.motor.foc.Iq_measured" => format!("{:.6}\r\n", self.motor.current_a),
            "r vbus_voltage" => format!("{:.6}\r\n", self.motor.voltage_v),
            "r axis0.error" => format!("{}\r\n", self.motor.fault),
            _ => "invalid property\r\n".to_owned(),
        };
        lines(&mut self.bytes, bytes).into_iter().flat_map(|line| answer(line).into_bytes()).collect()
    }
}
