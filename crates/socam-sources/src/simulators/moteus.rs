//! A simulated moteus.

use std::f64::consts::TAU;

use moteus_protocol::fdcanusb::{self, Line};
use moteus_protocol::{CanFdFrame, Register, Subframe, parse_arbitration_id, parse_frame};

use super::lines;
use super::motor::{Mishap, Motor, Want};

/// Modes.
const STOPPED: u8 = 0;
const FAULT: u8 = 1;
const POSITION: u8 = 10;
const TIMEOUT: u8 = 11;

/// A moteus behind an fdcanusb.
#[derive(Debug)]
pub struct MoteusSimulator {
    /// Number of the drive.
    pub id: u8,
    /// Its motor.
    pub motor: Motor,
    /// What is wrong with it.
    pub mishap: Option<Mishap>,
    /// Its mode, by the list of its register 0x000.
    pub mode: u8,
    /// Frames that commanded it, stops included.
    pub commands: u64,
    time_s: f64,
    command: Command,
    bytes: Vec<u8>,
}

/// The last command in position mode; turns and seconds, as on the wire.
#[derive(Debug, Clone, Copy)]
struct Command {
    velocity: f64,
    /// Torque that is fed forward, N m, and the scale of its own gains.
    torque_nm: f64,
    gain: f64,
    most_nm: f64,
    most_velocity: f64,
    watchdog_s: f64,
    until_s: f64,
}

impl MoteusSimulator {
    /// A drive with a motor.
    #[must_use]
    pub fn new(id: u8, motor: Motor) -> Self {
        let command = Command {
            velocity: 0.0,
            torque_nm: 0.0,
            gain: 1.0,
            most_nm: 0.0,
            most_velocity: f64::INFINITY,
            watchdog_s: 0.1,
            until_s: 0.0,
        };
        let mode = if motor.inertia.is_some() { STOPPED } else { POSITION };
        Self { id, motor, mishap: None, mode, commands: 0, time_s: 0.0, command, bytes: Vec::new() }
    }

    /// Moves on to a time since it was switched on, s.
    pub fn advance(&mut self, time_s: f64) {
        let seconds = (time_s - self.time_s).max(0.0);
        self.time_s += seconds;
        if self.mishap != Some(Mishap::Freezes) && self.mode == POSITION && self.motor.inertia.is_some() {
            // A watchdog of NaN never ends; any comparison with it is false.
            if self.time_s > self.command.until_s {
                self.mode = TIMEOUT;
            }
        }
        if let Some(Mishap::Fault(_)) = self.mishap {
            self.mode = FAULT;
        }
        self.motor.advance(seconds, self.want());
    }

    fn want(&self) -> Want {
        let factor = if matches!(self.mishap, Some(Mishap::Lies | Mishap::RunsAway)) { 2.0 } else { 1.0 };
        match (self.mishap, self.mode) {
            (Some(Mishap::Dies), _) => Want::Off,
            (_, POSITION) if self.command.gain == 0.0 => {
                let most_nm = self.command.most_nm;
                Want::Torque((factor * self.command.torque_nm).clamp(-most_nm, most_nm))
            }
            (_, POSITION) => {
                let most = self.command.most_velocity.abs();
                let velocity = self.command.velocity.max(-most).min(most);
                Want::Speed(factor * velocity * TAU, self.command.most_nm)
            }
            (_, TIMEOUT) => Want::Speed(0.0, 5.0),
            _ => Want::Off,
        }
    }

    /// Takes bytes at a time since it was switched on, s, and returns its answers.
    pub fn receive(&mut self, time_s: f64, bytes: &[u8]) -> Vec<u8> {
        self.advance(time_s);
        let mut answers = Vec::new();
        for line in lines(&mut self.bytes, bytes) {
            if matches!(self.mishap, Some(Mishap::Dies | Mishap::Freezes)) {
                continue;
            }
            let Some(sent) = line.strip_prefix("can send ") else {
                answers.extend_from_slice(b"ERR unknown command\r\n");
                continue;
            };
            answers.extend_from_slice(b"OK\r\n");
            // A frame that is sent is written like one that was received.
            let Line::Rcv(frame) = fdcanusb::parse_line(format!("rcv {sent}").as_bytes()) else { continue };
            let (_, to, _) = parse_arbitration_id(frame.arbitration_id);
            if to == self.id as i8 {
                self.obey(&frame);
                answers.extend(self.answer(&frame));
            }
        }
        answers
    }

    /// Takes what a frame writes.
    fn obey(&mut self, frame: &CanFdFrame) {
        // What a command does not hold is what the drive has for it.
        let (mut command, mut mode) = (Command { torque_nm: 0.0, gain: 1.0, ..self.command }, None);
        for part in parse_frame(frame.payload()) {
            let Subframe::Register { register, value: Some(value), .. } = part else { continue };
            let float = match value {
                moteus_protocol::Value::Float(float) => f64::from(float),
                other => f64::from(other.to_i32()),
            };
            match Register::from_address(register) {
                Some(Register::Mode) => mode = Some(value.to_i32() as u8),
                Some(Register::CommandVelocity) => command.velocity = float,
                Some(Register::CommandFeedforwardTorque) => command.torque_nm = float,
                Some(Register::CommandKpScale) => command.gain = float,
                Some(Register::CommandPositionMaxTorque) => command.most_nm = float,
                Some(Register::CommandTimeout) => command.watchdog_s = float,
                Some(Register::CommandVelocityLimit) => command.most_velocity = float,
                _ => {}
            }
        }
        self.commands += u64::from(mode.is_some());
        match mode {
            Some(STOPPED) => self.mode = STOPPED,
            // Only a stop leads out of a timeout or a fault.
            Some(POSITION) if !matches!(self.mode, TIMEOUT | FAULT) => {
                self.mode = POSITION;
                self.command = command;
                self.command.until_s = self.time_s + command.watchdog_s;
            }
            _ => {}
        }
    }

    /// The line with the registers that a frame asks for.
    fn answer(&self, frame: &CanFdFrame) -> Vec<u8> {
        let fault = if let Some(Mishap::Fault(code)) = self.mishap { code as u8 } else { 0 };
        let is_lying = self.mishap == Some(Mishap::Lies);
        let speed_rad_s = if is_lying { 0.0 } else { self.motor.speed_rad_s };
        let mode = if fault > 0 { FAULT } else { self.mode };
        let mut data: Vec<u8> = Vec::new();
        for part in parse_frame(frame.payload()) {
            let Subframe::Register { register, value: None, .. } = part else { continue };
            let small = |value: u8| (0x21, vec![value]);
            let float = |value: f64| (0x2d, (value as f32).to_le_bytes().to_vec());
            let (head, value) = match Register::from_address(register) {
                Some(Register::Mode) => small(mode),
                Some(Register::Position) => float(self.motor.angle_rad / TAU),
                Some(Register::Velocity) => float(speed_rad_s / TAU),
                Some(Register::Torque) => float(self.motor.torque_nm),
                Some(Register::QCurrent) => float(self.motor.current_a()),
                Some(Register::Voltage) => float(self.motor.voltage_v),
                Some(Register::Temperature) => float(35.0),
                Some(Register::Fault) => small(fault),
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
