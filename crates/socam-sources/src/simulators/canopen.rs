//! A simulated drive on a CAN bus, by CANopen.

mod control;

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::bus::Node;
use super::frame::Frame;
use super::motor::{Mishap, Motor};
use control::{Control, DISABLED};

/// Counts of its encoder per turn.
const COUNTS: f64 = 4096.0;
/// Interval of heartbeats, s.
const HEARTBEAT_S: f64 = 0.5;

/// A drive with CANopen: speed (606C, 0.1 rpm), torque (6077, 0.001 of 2 N m), position (6064, counts of 4096 a turn), statusword (6041). It obeys
/// controlword, mode and target velocity (6040, 6060, 60FF), keeps to 607F and 6072, and waits for a heartbeat (1016:01, 6007).
#[derive(Debug)]
pub struct CanopenSimulator {
    /// Its motor.
    pub motor: Motor,
    /// Its statusword.
    pub status: u16,
    /// Whether its master has started it, so that it sends PDOs.
    pub is_operational: bool,
    /// Interval of its first PDO (statusword and speed), s; `None` if it is not used.
    pub pdo_s: Option<f64>,
    /// Whether its second PDO (torque) follows SYNC; else it is not used.
    pub follows_sync: bool,
    /// What is wrong with it.
    pub mishap: Option<Mishap>,
    /// Whether it does nothing where the heartbeat that it waits for is missing.
    pub is_deaf: bool,
    /// Whether it says that it took limits and did not.
    pub ignores_limits: bool,
    /// Whether it refuses to write its target velocity.
    pub refuses_targets: bool,
    /// Objects that were written.
    pub writes: u64,
    control: Control,
    node: u32,
    time_s: f64,
    sent_s: f64,
    beat_s: f64,
}

impl CanopenSimulator {
    /// The node of a number with this motor, enabled, whose PDOs are not used.
    #[must_use]
    pub fn new(node: u8, motor: Motor) -> Self {
        Self {
            motor,
            status: 0x0237,
            is_operational: true,
            pdo_s: None,
            follows_sync: false,
            mishap: None,
            is_deaf: false,
            ignores_limits: false,
            refuses_targets: false,
            writes: 0,
            control: Control::new(),
            node: u32::from(node),
            time_s: 0.0,
            sent_s: 0.0,
            beat_s: 0.0,
        }
    }

    /// The same, disabled.
    #[must_use]
    pub fn disabled(node: u8, motor: Motor) -> Self {
        Self { status: 0x0210 | DISABLED, ..Self::new(node, motor) }
    }

    /// The present value of an object that can be written; 0 where there is none.
    #[must_use]
    pub fn setting(&self, index: u16, sub: u8) -> u32 {
        self.control.value((index, sub))
    }

    /// Sets an object that can be written, as its maker or another master did.
    pub fn set(&mut self, index: u16, sub: u8, value: u32) {
        if let Some((present, _)) = self.control.settings.get_mut(&(index, sub)) {
            *present = value;
        }
    }

    fn speed(&self) -> [u8; 4] {
        let speed_rad_s = if self.mishap == Some(Mishap::Lies) { 0.0 } else { self.motor.speed_rad_s };
        ((speed_rad_s * 600.0 / TAU).round() as i32).to_le_bytes()
    }

    fn torque(&self) -> [u8; 2] {
        ((self.motor.torque_nm * 500.0).round() as i16).to_le_bytes()
    }

    /// The objects that it has, with their bytes.
    fn objects(&self) -> BTreeMap<(u16, u8), Vec<u8>> {
        let long = |value: u32| value.to_le_bytes().to_vec();
        let off = |is_used: bool| if is_used { 0 } else { 0x8000_0000 };
        let mode = vec![self.control.value((0x6060, 0)) as u8];
        let settings = self.control.settings.iter();
        let settings =
            settings.map(|(place, (value, width))| (*place, value.to_le_bytes()[..*width].to_vec()));
        let fixed = BTreeMap::from([
            ((0x1800, 1), long(0x180 + self.node + off(self.pdo_s.is_some()))),
            ((0x1801, 1), long(0x280 + self.node + off(self.follows_sync))),
            ((0x1a00, 0), vec![2]),
            ((0x1a00, 1), long(0x6041_0010)),
            ((0x1a00, 2), long(0x606c_0020)),
            ((0x1a01, 0), vec![1]),
            ((0x1a01, 1), long(0x6077_0010)),
            ((0x603f, 0), self.control.error_code.to_le_bytes().to_vec()),
            ((0x6061, 0), mode),
            ((0x6041, 0), self.status.to_le_bytes().to_vec()),
            ((0x6064, 0), ((self.motor.angle_rad / TAU * COUNTS) as i64 as i32).to_le_bytes().to_vec()),
            ((0x606c, 0), self.speed().to_vec()),
            ((0x6077, 0), self.torque().to_vec()),
        ]);
        fixed.into_iter().chain(settings).collect()
    }

    /// An object is written; returns the answer.
    fn write(&mut self, place: (u16, u8), frame: &Frame) -> Vec<u8> {
        let mut answer = frame.bytes.clone();
        let value = u32::from_le_bytes([answer[4], answer[5], answer[6], answer[7]]);
        self.writes += 1;
        let is_known = !(self.refuses_targets && place.0 == 0x60ff)
            && self.control.write(place, value, self.ignores_limits, &mut self.status);
        answer[4..].fill(0);
        answer[0] = if is_known { 0x60 } else { 0x80 };
        if !is_known {
            answer[4..].copy_from_slice(&0x0601_0002_u32.to_le_bytes());
        }
        answer
    }

    fn is_silent(&self) -> bool {
        matches!(self.mishap, Some(Mishap::Dies | Mishap::Freezes))
    }
}

impl Node for CanopenSimulator {
    fn receive(&mut self, time_s: f64, frame: &Frame) -> Vec<Frame> {
        if self.is_silent() {
            return Vec::new();
        }
        if let 0x701..=0x77f = frame.id {
            self.control.beat(frame.id & 0x7f, time_s);
        }
        if frame.id == 0x80 && self.follows_sync && self.is_operational {
            return vec![Frame::data(0x280 + self.node, &self.torque())];
        }
        if frame.id != 0x600 + self.node || frame.bytes.len() != 8 {
            return Vec::new();
        }
        let place = (u16::from_le_bytes([frame.bytes[1], frame.bytes[2]]), frame.bytes[3]);
        match frame.bytes[0] {
            0x40 => {}
            0x20..=0x2f => return vec![Frame::data(0x580 + self.node, &self.write(place, frame))],
            _ => return Vec::new(),
        }
        let mut answer = frame.bytes.clone();
        match self.objects().get(&place) {
            Some(bytes) => {
                answer[0] = 0x43 | (4 - bytes.len() as u8) << 2;
                answer[4..4 + bytes.len()].copy_from_slice(bytes);
            }
            None => {
                answer[0] = 0x80;
                answer[4..].copy_from_slice(&0x0602_0000_u32.to_le_bytes());
            }
        }
        vec![Frame::data(0x580 + self.node, &answer)]
    }

    fn advance(&mut self, time_s: f64) -> Vec<Frame> {
        let seconds = (time_s - self.time_s).max(0.0);
        self.time_s += seconds;
        let wrong = (self.mishap, self.is_deaf);
        let want = self.control.advance(self.time_s, seconds, &mut self.status, &self.motor, wrong);
        self.motor.advance(seconds, want);
        let mut frames = Vec::new();
        if self.is_silent() {
            return frames;
        }
        if let Some(code) = self.control.emergency.take() {
            let [low, high] = code.to_le_bytes();
            let register = u8::from(code != 0);
            frames.push(Frame::data(0x80 + self.node, &[low, high, register, 0, 0, 0, 0, 0]));
        }
        if let Some(pdo_s) =
            self.pdo_s.filter(|pdo_s| self.is_operational && self.time_s - self.sent_s >= *pdo_s)
        {
            self.sent_s += pdo_s;
            let bytes = [self.status.to_le_bytes().as_slice(), &self.speed()].concat();
            frames.push(Frame::data(0x180 + self.node, &bytes));
        }
        if self.time_s - self.beat_s >= HEARTBEAT_S {
            self.beat_s = self.time_s;
            frames.push(Frame::data(0x700 + self.node, &[if self.is_operational { 5 } else { 0x7f }]));
        }
        frames
    }
}
