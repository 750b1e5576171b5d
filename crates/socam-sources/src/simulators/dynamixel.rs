//! A simulated Dynamixel servo of the X series.

use std::f64::consts::TAU;

use super::motor::Motor;

const CHECKSUM: crc::Crc<u16> = crc::Crc::<u16>::new(&crc::CRC_16_UMTS);

/// A servo, turned by something else. It answers to reading alone.
#[derive(Debug)]
pub struct DynamixelSimulator {
    /// Number of the servo, and of its model.
    pub id: u8,
    /// Number of the model.
    pub model: u16,
    /// Its motor.
    pub motor: Motor,
    /// Error of its answers.
    pub error: u8,
    /// Packets that were no reading.
    pub commands: u64,
    bytes: Vec<u8>,
}

impl DynamixelSimulator {
    /// A servo with a motor.
    #[must_use]
    pub fn new(id: u8, model: u16, motor: Motor) -> Self {
        Self { id, model, motor, error: 0, commands: 0, bytes: Vec::new() }
    }

    /// Takes bytes at a time since it was switched on, s, and returns its answers. Servos of one bus are given the same bytes.
    pub fn receive(&mut self, time_s: f64, bytes: &[u8]) -> Vec<u8> {
        self.bytes.extend_from_slice(bytes);
        let mut answers = Vec::new();
        // All packets that are sent to it begin where the one before ends.
        while let &[_, _, _, _, _, low, high, ..] = &self.bytes[..] {
            let length = 7 + usize::from(u16::from_le_bytes([low, high]));
            if self.bytes.len() < length {
                break;
            }
            let packet: Vec<u8> = self.bytes.drain(..length).collect();
            let (body, sum) = packet.split_at(length - 2);
            let is_right = CHECKSUM.checksum(body).to_le_bytes() == sum;
            match *body {
                [0xff, 0xff, 0xfd, 0, to, _, _, instruction, a0, a1, n0, n1, ref listed @ ..] if is_right => {
                    let (address, length) = (u16::from_le_bytes([a0, a1]), u16::from_le_bytes([n0, n1]));
                    match (to, instruction) {
                        (id, 0x02) if id == self.id => answers.extend(self.answer(time_s, address, length)),
                        (0xfe, 0x82) if listed.contains(&self.id) => {
                            answers.extend(self.answer(time_s, address, length));
                        }
                        (_, 0x02 | 0x82) => {}
                        _ => self.commands += 1,
                    }
                }
                _ => self.commands += 1,
            }
        }
        answers
    }

    fn answer(&self, time_s: f64, address: u16, length: u16) -> Vec<u8> {
        let mut registers = [0_u8; 200];
        let mut put =
            |address: usize, bytes: &[u8]| registers[address..address + bytes.len()].copy_from_slice(bytes);
        put(0, &self.model.to_le_bytes());
        put(48, &4095_i32.to_le_bytes());
        put(126, &((self.motor.current_a() / 2.69e-3).round() as i16).to_le_bytes());
        put(128, &((self.motor.speed_rad_s * 60.0 / TAU / 0.229).round() as i32).to_le_bytes());
        put(132, &((self.motor.speed_rad_s * time_s * 4096.0 / TAU).round() as i32).to_le_bytes());
        put(144, &((self.motor.voltage_v * 10.0) as u16).to_le_bytes());
        put(146, &[35]);
        let mut plain = vec![0x55, self.error];
        plain.extend_from_slice(&registers[usize::from(address)..usize::from(address + length)]);
        let mut stuffed = Vec::new();
        for byte in plain {
            stuffed.push(byte);
            if stuffed.ends_with(&[0xff, 0xff, 0xfd]) {
                stuffed.push(0xfd);
            }
        }
        let mut packet = vec![0xff, 0xff, 0xfd, 0, self.id];
        packet.extend(((stuffed.len() + 2) as u16).to_le_bytes());
        packet.extend(stuffed);
        packet.extend(CHECKSUM.checksum(&packet).to_le_bytes());
        packet
    }
}
