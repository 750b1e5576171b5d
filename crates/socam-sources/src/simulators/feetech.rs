//! A simulated Feetech servo of the STS series.

use std::f64::consts::TAU;

use super::motor::Motor;

/// A servo, turned by something else. It answers to reading alone.
#[derive(Debug)]
pub struct FeetechSimulator {
    /// Number of the servo.
    pub id: u8,
    /// Number of its model.
    pub model: u16,
    /// Its settings of speed, current and directions (register 18).
    pub phase: u8,
    /// Register 2: 0, or 1 for the order of bytes of the SCS series.
    pub byte_order: u8,
    /// Its motor.
    pub motor: Motor,
    /// Error of its answers.
    pub error: u8,
    /// Whether the line returns what is sent, as adapters of one wire do; of one servo of a bus.
    pub echoes: bool,
    /// Packets that were no reading.
    pub commands: u64,
    bytes: Vec<u8>,
}

impl FeetechSimulator {
    /// An STS3215 with a motor.
    #[must_use]
    pub fn new(id: u8, motor: Motor) -> Self {
        Self {
            id,
            model: 777,
            phase: 12,
            byte_order: 0,
            motor,
            error: 0,
            echoes: false,
            commands: 0,
            bytes: Vec::new(),
        }
    }

    /// Takes bytes at a time since it was switched on, s, and returns its answers. Servos of one bus are given the same bytes.
    pub fn receive(&mut self, time_s: f64, bytes: &[u8]) -> Vec<u8> {
        self.bytes.extend_from_slice(bytes);
        let mut answers = if self.echoes { bytes.to_vec() } else { Vec::new() };
        while let &[_, _, _, length, ..] = &self.bytes[..] {
            let length = 4 + usize::from(length);
            if self.bytes.len() < length {
                break;
            }
            let packet: Vec<u8> = self.bytes.drain(..length).collect();
            let is_right = packet[2..].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte)) == 0xff;
            match packet[..length - 1] {
                [0xff, 0xff, 0xfe, _, 0x82, address, count, ref listed @ ..] if is_right => {
                    if listed.contains(&self.id) {
                        answers.extend(self.answer(time_s, address.into(), count.into()));
                    }
                }
                _ => self.commands += 1,
            }
        }
        answers
    }

    fn answer(&self, time_s: f64, address: usize, count: usize) -> Vec<u8> {
        let mut registers = [0_u8; 128];
        let mut put =
            |address: usize, bytes: &[u8]| registers[address..address + bytes.len()].copy_from_slice(bytes);
        let signed = |value: f64, sign: u16| {
            let magnitude = value.abs().round() as u16 & !sign;
            (if value < 0.0 { magnitude | sign } else { magnitude }).to_le_bytes()
        };
        let step_rad = TAU / 4096.0;
        let speed_steps = if self.phase & 4 != 0 { 1.0 } else { 50.0 };
        let position = (self.motor.speed_rad_s * time_s / step_rad) % 4096.0;
        put(2, &[self.byte_order]);
        put(3, &self.model.to_le_bytes());
        put(11, &4095_u16.to_le_bytes());
        put(18, &[self.phase]);
        put(30, &[1]);
        put(56, &signed(position, 1 << 15));
        put(58, &signed(self.motor.speed_rad_s / step_rad / speed_steps, 1 << 15));
        put(60, &signed(-250.0, 1 << 10));
        put(62, &[(self.motor.voltage_v * 10.0) as u8, 35]);
        put(69, &signed(self.motor.current_a() / 6.5e-3, 1 << 15));
        let values = &registers[address..address + count];
        let mut packet = vec![0xff, 0xff, self.id, count as u8 + 2, self.error];
        packet.extend_from_slice(values);
        packet.push(!packet[2..].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte)));
        packet
    }
}
