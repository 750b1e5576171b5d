//! A simulated adapter of CAN that speaks slcan.

use super::frame::Frame;

/// An adapter. It hands on frames once it is open, and sends some if it was opened for that.
#[derive(Debug, Default)]
pub struct SlcanSimulator {
    /// Whether it knows time stamps.
    pub has_stamps: bool,
    /// Flags that it states.
    pub flags: u8,
    /// All commands that it got.
    pub commands: Vec<String>,
    /// Frames that it was told to send.
    pub(super) sent: Vec<Frame>,
    is_open: bool,
    may_send: bool,
    stamps: bool,
    line: Vec<u8>,
}

impl SlcanSimulator {
    /// A closed adapter.
    #[must_use]
    pub fn new(has_stamps: bool) -> Self {
        Self { has_stamps, ..Self::default() }
    }

    /// Takes bytes and returns its answers.
    pub fn receive(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut answers = Vec::new();
        for byte in bytes {
            if *byte != b'\r' {
                self.line.push(*byte);
                continue;
            }
            let command = String::from_utf8_lossy(&std::mem::take(&mut self.line)).into_owned();
            let is_known = match command.as_str() {
                "" => true,
                "C" => {
                    (self.is_open, self.may_send) = (false, false);
                    true
                }
                "L" | "O" => {
                    (self.is_open, self.may_send) = (true, command == "O");
                    true
                }
                frame if self.may_send && frame.starts_with(['t', 'r']) => {
                    let frame = Frame::of(frame);
                    self.sent.extend(frame.clone());
                    frame.is_some()
                }
                "Z1" => {
                    self.stamps = self.has_stamps;
                    self.has_stamps
                }
                "F" if self.is_open => {
                    answers.extend_from_slice(format!("F{:02X}", self.flags).as_bytes());
                    true
                }
                rate => rate.len() == 2 && rate.starts_with('S'),
            };
            answers.push(if is_known { b'\r' } else { 0x07 });
            self.commands.push(command);
        }
        answers
    }

    /// The line of a frame on the bus at a time, s; nothing while it is closed.
    #[must_use]
    pub fn frame(&self, time_s: f64, id: u32, bytes: &[u8]) -> Vec<u8> {
        if !self.is_open {
            return Vec::new();
        }
        let data: String = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
        let stamp =
            if self.stamps { format!("{:04X}", (time_s * 1e3) as u64 % 60_000) } else { String::new() };
        format!("t{id:03X}{}{data}{stamp}\r", bytes.len()).into_bytes()
    }
}
