//! The adapter's side of slcan, for a bus to which this system has a socket: above its lines such a bus is one like any other.

use super::slcan::{CanFrame, Said, Stream, line};
use crate::device::Chunk;

/// Bits of an error frame of Linux (`linux/can/error.h`): the classes, and those of its second byte that matter.
const LOST_ARBITRATION: u32 = 0x02;
const CONTROLLER: u32 = 0x04;
const PROTOCOL: u32 = 0x08;
const NO_ACKNOWLEDGE: u32 = 0x20;
const BUS_OFF: u32 = 0x40;
const BUS_ERROR: u32 = 0x80;
const RX_OVERFLOW: u8 = 0x01;
const WARNING: u8 = 0x04 | 0x08;
const PASSIVE: u8 = 0x10 | 0x20;
const ACTIVE: u8 = 0x40;
/// Longest command that is kept.
const LONGEST: usize = 64;

/// A frame that is to leave for the bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outgoing {
    /// A frame with data.
    Data(CanFrame),
    /// A question for the data of this identifier of 11 bits.
    Remote(u32),
}

/// An adapter that is no hardware: it takes commands, lets frames pass only as far as it was opened, and answers.
#[derive(Debug, Default)]
pub struct Gateway {
    is_open: bool,
    may_send: bool,
    command: Vec<u8>,
    answers: Vec<u8>,
}

impl Gateway {
    /// Takes the bytes of commands; returns the frames that are to leave. Opened to listen only, it lets none pass.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<Outgoing> {
        let mut frames = Vec::new();
        for byte in bytes {
            match byte {
                b'\r' => {
                    let command = std::mem::take(&mut self.command);
                    match self.command(&command) {
                        Ok(frame) => {
                            self.answers.push(b'\r');
                            frames.extend(frame);
                        }
                        Err(()) => self.answers.push(0x07),
                    }
                }
                _ if self.command.len() < LONGEST => self.command.push(*byte),
                _ => {}
            }
        }
        frames
    }

    fn command(&mut self, command: &[u8]) -> Result<Option<Outgoing>, ()> {
        match command {
            b"C" => (self.is_open, self.may_send) = (false, false),
            b"L" => (self.is_open, self.may_send) = (true, false),
            b"O" => (self.is_open, self.may_send) = (true, true),
            b"" | b"Z1" => {}
            [b't' | b'T' | b'r', ..] if self.may_send => return outgoing(command).map(Some).ok_or(()),
            // The system has no flags: its errors come as they happen.
            _ => return Err(()),
        }
        Ok(None)
    }

    /// Answers to commands so far, as an adapter sends them.
    pub fn answers(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.answers)
    }

    /// The line of a frame that arrived at a time of any clock that does not go back, us; nothing while it is closed.
    #[must_use]
    pub fn arrived(&self, id: u32, is_extended: bool, bytes: &[u8], time_us: u64) -> Vec<u8> {
        if !self.is_open {
            return Vec::new();
        }
        let mut text = line(id, is_extended, bytes);
        text.pop();
        text.extend(format!("{:08X}\r", time_us as u32).bytes());
        text
    }

    /// The lines of an error frame of Linux: its class and its eight bytes; nothing where it holds no error of the bus.
    #[must_use]
    pub fn failed(&self, class: u32, bytes: &[u8]) -> Vec<u8> {
        let controller = if class & CONTROLLER != 0 { bytes.get(1).copied().unwrap_or(0) } else { 0 };
        let state = match () {
            () if class & BUS_OFF != 0 => Some(b'b'),
            () if controller & PASSIVE != 0 => Some(b'p'),
            () if controller & WARNING != 0 => Some(b'w'),
            () if controller & ACTIVE != 0 => Some(b'a'),
            () => None,
        };
        let mut lines = Vec::new();
        if let Some(state) = state.filter(|_| self.is_open) {
            lines.extend([b's', state]);
            lines.extend_from_slice(b"000000\r");
        }
        let is_damaged = class & (PROTOCOL | BUS_ERROR) != 0;
        let letters = [
            (class & NO_ACKNOWLEDGE != 0, b'a'),
            (is_damaged && class & (NO_ACKNOWLEDGE | LOST_ARBITRATION) == 0, b'f'),
            (controller & RX_OVERFLOW != 0, b'o'),
        ];
        let letters: Vec<u8> =
            letters.into_iter().filter_map(|(is_so, letter)| is_so.then_some(letter)).collect();
        if !letters.is_empty() && self.is_open {
            lines.extend([b'e', b'0' + letters.len() as u8]);
            lines.extend(letters);
            lines.push(b'\r');
        }
        lines
    }
}

/// The frame of a command that sends one.
fn outgoing(command: &[u8]) -> Option<Outgoing> {
    let (mut said, mut stream) = (None, Stream::default());
    for bytes in [command, b"\r"] {
        stream.push(Chunk { bytes, from_ns: 0, until_ns: 0 }, |one, _| said = Some(one));
    }
    match said? {
        Said::Frame(frame @ CanFrame { stamp: None, .. }) => Some(Outgoing::Data(frame)),
        Said::Remote => {
            let id = std::str::from_utf8(command.get(1..4)?).ok()?;
            Some(Outgoing::Remote(u32::from_str_radix(id, 16).ok()?))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gateway_sends_only_what_it_was_opened_for() {
        let mut gateway = Gateway::default();
        let frame = |id, bytes: &[u8]| {
            Outgoing::Data(CanFrame { id, is_extended: false, bytes: bytes.to_vec(), stamp: None })
        };
        assert!(gateway.take(b"t1012AABB\r").is_empty() && gateway.arrived(1, false, &[], 0).is_empty());
        assert!(gateway.take(b"\rC\rZ1\rL\rt1012AABB\rr1010\r").is_empty());
        assert_eq!(gateway.answers(), b"\x07\r\r\r\r\x07\x07");
        // A command may come in pieces.
        assert!(gateway.take(b"C\rO\rt1012A").is_empty());
        assert_eq!(gateway.take(b"ABB\rr0290\r"), [frame(0x101, &[0xaa, 0xbb]), Outgoing::Remote(0x29)]);
        assert!(gateway.take(b"t9992AABB\rt1012AAB\rF\r").is_empty());
        assert_eq!(gateway.answers(), b"\r\r\r\r\x07\x07\x07");
        assert_eq!(gateway.arrived(0x101, false, &[1], 0x1_0000_0002), b"t10110100000002\r");
    }

    #[test]
    fn errors_of_the_system_become_lines_of_an_adapter() {
        let mut gateway = Gateway::default();
        gateway.take(b"L\r");
        assert_eq!(gateway.failed(BUS_OFF, &[0; 8]), b"sb000000\r");
        assert_eq!(gateway.failed(CONTROLLER, &[0, RX_OVERFLOW, 0, 0, 0, 0, 0, 0]), b"e1o\r");
        assert_eq!(gateway.failed(CONTROLLER, &[0, 0x10, 0, 0, 0, 0, 0, 0]), b"sp000000\r");
        assert_eq!(gateway.failed(PROTOCOL | BUS_ERROR, &[0; 8]), b"e1f\r");
        assert_eq!(gateway.failed(PROTOCOL | BUS_ERROR | NO_ACKNOWLEDGE, &[0; 8]), b"e1a\r");
        assert!(gateway.failed(LOST_ARBITRATION, &[]).is_empty());
    }
}
