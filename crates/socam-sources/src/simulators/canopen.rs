//! A simulated drive on a CAN bus, by CANopen.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::bus::Node;
use super::frame::Frame;
use super::motor::{Motor, Want};

/// Counts of its encoder per turn.
const COUNTS: f64 = 4096.0;
/// Interval of heartbeats, s.
const HEARTBEAT_S: f64 = 0.5;

/// A drive with CANopen: speed (606C, 0.1 rpm), torque (6077, 0.001 of 2 N m), position (6064, counts of 4096 a turn), statusword (6041).
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
            node: u32::from(node),
            time_s: 0.0,
            sent_s: 0.0,
            beat_s: 0.0,
        }
    }

    fn speed(&self) -> [u8; 4] {
        ((self.motor.speed_rad_s * 600.0 / TAU).round() as i32).to_le_bytes()
    }

    fn torque(&self) -> [u8; 2] {
        ((self.motor.torque_nm * 500.0).round() as i16).to_le_bytes()
    }

    /// The objects that it has, with their bytes.
    fn objects(&self) -> BTreeMap<(u16, u8), Vec<u8>> {
        let long = |value: u32| value.to_le_bytes().to_vec();
        let off = |is_used: bool| if is_used { 0 } else { 0x8000_0000 };
        BTreeMap::from([
            ((0x1800, 1), long(0x180 + self.node + off(self.pdo_s.is_some()))),
            ((0x1801, 1), long(0x280 + self.node + off(self.follows_sync))),
            ((0x1a00, 0), vec![2]),
            ((0x1a00, 1), long(0x6041_0010)),
            ((0x1a00, 2), long(0x606c_0020)),
            ((0x1a01, 0), vec![1]),
            ((0x1a01, 1), long(0x6077_0010)),
            ((0x6041, 0), self.status.to_le_bytes().to_vec()),
            ((0x6064, 0), ((self.motor.angle_rad / TAU * COUNTS) as i64 as i32).to_le_bytes().to_vec()),
            ((0x606c, 0), self.speed().to_vec()),
            ((0x6077, 0), self.torque().to_vec()),
        ])
    }
}

impl Node for CanopenSimulator {
    fn receive(&mut self, _: f64, frame: &Frame) -> Vec<Frame> {
        if frame.id == 0x80 && self.follows_sync && self.is_operational {
            return vec![Frame::data(0x280 + self.node, &self.torque())];
        }
        if frame.id != 0x600 + self.node || frame.bytes.len() != 8 || frame.bytes[0] != 0x40 {
            return Vec::new();
        }
        let place = (u16::from_le_bytes([frame.bytes[1], frame.bytes[2]]), frame.bytes[3]);
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
        self.motor.advance(seconds, Want::Off);
        let mut frames = Vec::new();
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
