//! A moteus servo drive behind an fdcanusb, which sends frames of CAN FD as lines of text. It is asked for each sample.

use std::f64::consts::TAU;

use moteus_protocol::fdcanusb::{self, EncodeOptions, Line};
use moteus_protocol::query::QueryFormat;
use moteus_protocol::{CanFdFrame, Register, Resolution, calculate_arbitration_id, parse_arbitration_id};
use moteus_protocol::{Value, scaling};
use socam_recording::Channel;
use socam_units::Unit;

use crate::asking::Asking;
use crate::device::{Chunk, Device, Heard, Numbering};
use crate::error::Result;
use crate::text::lines::Lines;

/// Kelvins at 0 degrees Celsius.
const ZERO_CELSIUS_K: f64 = 273.15;
/// Mode of a drive in a fault.
const FAULT: f64 = 1.0;

/// What is read of a drive: register, name, unit, and SI value of one.
const READ: [(Register, &str, Unit, f64); 8] = [
    (Register::Mode, "mode", Unit::One, 1.0),
    (Register::Position, "position", Unit::Rad, TAU),
    (Register::Velocity, "speed", Unit::RadPerS, TAU),
    (Register::Torque, "torque", Unit::Nm, 1.0),
    (Register::QCurrent, "current", Unit::A, 1.0),
    (Register::Voltage, "voltage", Unit::V, 1.0),
    (Register::Temperature, "temperature", Unit::K, 1.0),
    (Register::Fault, "fault", Unit::One, 1.0),
];

/// A drive that is asked; it is never commanded.
#[derive(Debug)]
pub struct Moteus {
    id: u8,
    channels: Vec<Channel>,
    question: Vec<u8>,
    asking: Asking,
    lines: Lines,
    fault: Option<f64>,
}

impl Moteus {
    /// The drive of this number (1 to 127), asked at this interval.
    ///
    /// # Errors
    /// When no drive has this number.
    pub fn new(id: u8, period_ns: i64) -> Result<Self> {
        if !(1..=127).contains(&id) {
            let problem =
                format!("{id} is no number of a moteus; expected 1 to 127, as in moteus:/dev/fdcanusb?id=1");
            return Err(crate::SourceError::Foreign(problem));
        }
        Ok(Self {
            id,
            channels: READ.iter().map(|(_, name, unit, _)| Channel::new(*name, *unit)).collect(),
            question: question(id),
            asking: Asking::new(period_ns),
            lines: Lines::answers(),
            fault: None,
        })
    }

    /// The row of an answer; `None` for frames of others.
    fn row(&mut self, frame: &CanFdFrame, heard: &mut Vec<Heard>) -> Result<Option<Vec<f64>>, &'static str> {
        let (from, to, _) = parse_arbitration_id(frame.arbitration_id);
        if (from, to) != (self.id as i8, 0) {
            return Ok(None);
        }
        let mut values = vec![f64::NAN; READ.len()];
        for (register, value) in registers(frame.payload())? {
            let Some(place) = READ.iter().position(|(known, ..)| known.address() == register) else {
                continue;
            };
            let number = match READ[place].0 {
                Register::Mode | Register::Fault => f64::from(value.to_i32()),
                Register::Position => value.to_f32(&scaling::POSITION).into(),
                Register::Velocity => value.to_f32(&scaling::VELOCITY).into(),
                Register::Torque => value.to_f32(&scaling::TORQUE).into(),
                Register::QCurrent => value.to_f32(&scaling::CURRENT).into(),
                Register::Voltage => value.to_f32(&scaling::VOLTAGE).into(),
                _ => f64::from(value.to_f32(&scaling::TEMPERATURE)) + ZERO_CELSIUS_K,
            };
            values[place] = if number.is_finite() { number * READ[place].3 } else { f64::NAN };
        }
        if values[..3].iter().any(|value| value.is_nan()) {
            return Err("an answer lacks mode, position or speed");
        }
        let fault = Some(values[7]).filter(|_| values[0] == FAULT);
        if fault != self.fault {
            self.fault = fault;
            heard.extend(fault.map(|code| Heard::Fault(format!("the moteus reports fault {code}"))));
        }
        Ok(Some(values))
    }
}

/// Registers of an answer. The parser of `moteus-protocol` is not used here: it panics where a number in a frame is too long.
fn registers(data: &[u8]) -> Result<Vec<(u16, Value)>, &'static str> {
    const RESPONSE: u8 = 0x20;
    const NOTHING: u8 = 0x50;
    let short = "an answer ends within a register";
    let (mut rest, mut found) = (data, Vec::new());
    let byte = |rest: &mut &[u8]| {
        let (first, behind) = rest.split_first()?;
        *rest = behind;
        Some(*first)
    };
    while let Some(head) = byte(&mut rest) {
        match head {
            NOTHING => continue,
            RESPONSE..=0x2f => {}
            _ => return Err("an answer holds something else than registers"),
        }
        let count = match head & 3 {
            0 => byte(&mut rest).ok_or(short)?,
            count => count,
        };
        // All registers that are asked for have numbers of one byte.
        let first = byte(&mut rest)
            .filter(|first| *first < 0x80)
            .ok_or("an answer holds a register that was not asked for")?;
        for index in 0..count {
            let width = [1, 2, 4, 4][usize::from(head >> 2 & 3)];
            let (bytes, behind) = rest.split_at_checked(width).ok_or(short)?;
            rest = behind;
            let value = match (head >> 2 & 3, bytes) {
                (0, [byte]) => Value::Int8(*byte as i8),
                (1, [low, high]) => Value::Int16(i16::from_le_bytes([*low, *high])),
                (2, [a, b, c, d]) => Value::Int32(i32::from_le_bytes([*a, *b, *c, *d])),
                (_, [a, b, c, d]) => Value::Float(f32::from_le_bytes([*a, *b, *c, *d])),
                _ => return Err(short),
            };
            found.push((u16::from(first) + u16::from(index), value));
        }
    }
    Ok(found)
}

/// The line that asks for all registers of [`READ`].
fn question(id: u8) -> Vec<u8> {
    let mut format = QueryFormat::default();
    format.q_current = Resolution::Float;
    format.voltage = Resolution::Float;
    format.temperature = Resolution::Float;
    let mut frame = CanFdFrame::new();
    frame.arbitration_id = calculate_arbitration_id(0, id as i8, 0, true);
    format.serialize(&mut frame);
    let mut line = [0; fdcanusb::MAX_LINE_LENGTH];
    // The buffer suffices for every frame.
    let length = fdcanusb::encode_can_send(&frame, &EncodeOptions::default(), &mut line).unwrap_or(0);
    line[..length].to_vec()
}

impl Device for Moteus {
    fn kind(&self) -> String {
        format!("the moteus {} behind an fdcanusb, which is only asked", self.id)
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        Numbering::Arrival
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        self.asking.take_missing(heard);
        let mut lines = std::mem::take(&mut self.lines);
        lines.push(chunk, |line, arrival_ns| {
            let (content, has_sum, is_right) =
                fdcanusb::strip_checksum(line.map(str::as_bytes).unwrap_or_default());
            let read = match (line, fdcanusb::parse_line(content)) {
                (Err(problem), _) => Err(problem),
                _ if has_sum && !is_right => Err("the checksum of a line is wrong"),
                (_, Line::Ok) => return,
                (_, Line::Rcv(frame)) => self.row(&frame, heard),
                (_, Line::Err(_)) => Err("the fdcanusb reports an error"),
                (_, Line::Other(_)) => Err("a line is none of an fdcanusb"),
            };
            match read {
                Ok(Some(values)) => heard.push(self.asking.answered(arrival_ns, values)),
                Ok(None) => {}
                Err(problem) => heard.push(Heard::Damaged(problem)),
            }
        });
        self.lines = lines;
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        Ok(Some(self.asking.poll(now_ns, &self.question, out)))
    }

    fn awaits(&self) -> bool {
        self.asking.awaits()
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        if self.lines.interrupt() {
            heard.push(Heard::Damaged("the link broke within it"));
        }
        self.asking.forget();
    }
}
