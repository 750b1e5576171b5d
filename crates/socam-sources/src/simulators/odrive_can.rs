//! A simulated ODrive on a CAN bus, by CAN Simple.

use std::f64::consts::TAU;

use super::bus::Node;
use super::frame::Frame;
use super::motor::{Mishap, Motor, Want};
use super::odrive::{Firmware, faded_nm};

/// States of an axis.
const IDLE: u8 = 1;
const CLOSED_LOOP: u8 = 8;
/// Control of speed and of torque, of commands that are taken as they are.
const SPEED: (u32, u32) = (2, 1);
const TORQUE: (u32, u32) = (1, 1);
/// Time between heartbeats, and between encoder estimates that it sends by itself, s: those of its maker.
const HEARTBEAT_S: f64 = 0.1;
const ENCODER_S: f64 = 0.01;

/// An ODrive with CAN Simple.
#[derive(Debug)]
pub struct OdriveCanSimulator {
    /// Its motor.
    pub motor: Motor,
    /// What is wrong with it.
    pub mishap: Option<Mishap>,
    /// Time without a message after which it switches off, s; `None` if its watchdog is off.
    pub watchdog_s: Option<f64>,
    /// State of its axis.
    pub state: u8,
    /// Its error.
    pub error: u32,
    /// Frames that commanded it or changed its settings.
    pub commands: u64,
    /// Limits of speed, turns/s, and current, A.
    pub limits: (f64, f64),
    node: u32,
    firmware: Firmware,
    /// Whether it limits its speed under a torque.
    pub is_torque_limited: bool,
    /// What it controls and how it takes commands, by the numbers of the protocol.
    modes: (u32, u32),
    velocity: f64,
    torque_nm: f64,
    fed_s: f64,
    time_s: f64,
    beat_s: f64,
    encoder_s: f64,
}

impl OdriveCanSimulator {
    /// The node of a number with this motor, whose watchdog of 0.2 s is on.
    #[must_use]
    pub fn new(node: u8, firmware: Firmware, motor: Motor) -> Self {
        Self {
            motor,
            mishap: None,
            watchdog_s: Some(0.2),
            state: IDLE,
            error: 0,
            commands: 0,
            limits: (20.0, 10.0),
            node: u32::from(node),
            firmware,
            is_torque_limited: true,
            modes: (3, 5),
            velocity: 0.0,
            torque_nm: 0.0,
            fed_s: 0.0,
            time_s: 0.0,
            beat_s: 0.0,
            encoder_s: 0.0,
        }
    }

    fn frame(&self, command: u32, bytes: [[u8; 4]; 2]) -> Frame {
        Frame::data(self.node << 5 | command, bytes.as_flattened())
    }

    fn numbers(&self, command: u32, first: f64, second: f64) -> Frame {
        self.frame(command, [first, second].map(|number| (number as f32).to_le_bytes()))
    }

    fn encoder(&self) -> Frame {
        let speed_rad_s = if self.mishap == Some(Mishap::Lies) { 0.0 } else { self.motor.speed_rad_s };
        self.numbers(0x09, self.motor.angle_rad / TAU, speed_rad_s / TAU)
    }

    fn turn(&mut self, time_s: f64) {
        let seconds = (time_s - self.time_s).max(0.0);
        self.time_s += seconds;
        if self.mishap != Some(Mishap::Freezes) {
            let is_late = self.watchdog_s.is_some_and(|watchdog_s| self.time_s - self.fed_s > watchdog_s);
            if is_late {
                self.error |= if self.firmware == Firmware::Early { 0x800 } else { 0x100_0000 };
            }
            if let Some(Mishap::Fault(code)) = self.mishap {
                self.error |= code;
            }
            if self.error != 0 {
                self.state = IDLE;
            }
        }
        let factor = if matches!(self.mishap, Some(Mishap::Lies | Mishap::RunsAway)) { 2.0 } else { 1.0 };
        let (most, current_a) = self.limits;
        let is_obeying = self.state == CLOSED_LOOP && self.mishap != Some(Mishap::Dies);
        let most_nm = current_a * self.motor.torque_constant_nm_a;
        let want = match self.modes {
            SPEED if is_obeying => Want::Speed(factor * self.velocity.clamp(-most, most) * TAU, most_nm),
            TORQUE if is_obeying => {
                let torque_nm = (factor * self.torque_nm).clamp(-most_nm, most_nm);
                let speed = self.motor.speed_rad_s / TAU;
                Want::Torque(if self.is_torque_limited {
                    faded_nm(torque_nm, speed, most)
                } else {
                    torque_nm
                })
            }
            _ => Want::Off,
        };
        self.motor.advance(seconds, want);
    }

    fn is_silent(&self) -> bool {
        matches!(self.mishap, Some(Mishap::Dies | Mishap::Freezes))
    }

    fn answer(&self, command: u32) -> Option<Frame> {
        let motor = &self.motor;
        Some(match (command, self.firmware) {
            (0x00, Firmware::Late) => self.frame(0x00, [[2, 4, 4, 58], [0, 6, 10, 0]]),
            (0x09, _) => self.encoder(),
            (0x14, _) => self.numbers(0x14, 0.0, motor.current_a()),
            (0x15, Firmware::Late) => self.numbers(0x15, 31.5, f64::NAN),
            // Estimates without an encoder, which nobody wants.
            (0x15, Firmware::Early) => self.numbers(0x15, 1e3, 1e3),
            (0x17, _) => self.numbers(0x17, motor.voltage_v, 0.5),
            _ => return None,
        })
    }

    fn command(&mut self, command: u32, bytes: &[u8]) {
        let word = |at: usize| {
            let bytes = bytes.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
            u32::from_le_bytes(bytes.unwrap_or([0; 4]))
        };
        let number = |at: usize| f64::from(f32::from_bits(word(at)));
        self.commands += 1;
        match command {
            // An axis in an error stays idle.
            0x07 if self.error == 0 || word(0) == u32::from(IDLE) => self.state = word(0) as u8,
            0x0b => self.modes = (word(0), word(4)),
            0x0d => self.velocity = number(0),
            0x0e => self.torque_nm = number(0),
            0x0f => self.limits = (number(0), number(4)),
            0x18 => self.error = 0,
            _ => {}
        }
    }
}

impl Node for OdriveCanSimulator {
    fn receive(&mut self, time_s: f64, frame: &Frame) -> Vec<Frame> {
        self.turn(time_s);
        if frame.id >> 5 != self.node || self.is_silent() {
            return Vec::new();
        }
        self.fed_s = self.time_s;
        if frame.is_remote {
            return self.answer(frame.id & 0x1f).into_iter().collect();
        }
        self.command(frame.id & 0x1f, &frame.bytes);
        Vec::new()
    }

    fn advance(&mut self, time_s: f64) -> Vec<Frame> {
        self.turn(time_s);
        let mut frames = Vec::new();
        if self.is_silent() {
            return frames;
        }
        if self.time_s - self.encoder_s >= ENCODER_S {
            self.encoder_s = self.time_s;
            frames.push(self.encoder());
        }
        if self.time_s - self.beat_s >= HEARTBEAT_S {
            self.beat_s = self.time_s;
            frames.push(self.frame(0x01, [self.error.to_le_bytes(), [self.state, 0, 0, 0]]));
        }
        frames
    }
}
