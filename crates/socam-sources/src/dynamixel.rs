//! A Dynamixel servo of the X series by its protocol 2. It is asked for each sample, and never commanded.

mod packet;

use std::f64::consts::TAU;

use socam_recording::Channel;
use socam_units::Unit;

use crate::ZERO_CELSIUS_K;
use crate::asking::Asking;
use crate::device::{Chunk, Device, Heard, Numbering};
use crate::error::Result;
use packet::{Packets, Status, read};

/// Registers that are read: the model once, then current, speed, position, voltage and temperature with what lies between them.
const MODEL: (u16, u16) = (0, 2);
const SAMPLE: (u16, u16) = (126, 21);
/// Positions in a turn, and the unit of speeds, rpm.
const POSITIONS: f64 = 4096.0;
const SPEED_RPM: f64 = 0.229;
/// Bit of the error of an answer that says that its register of hardware errors holds one.
const ALERT: u8 = 0x80;
/// The unit of the measured current by number of the model, A. Servos that are not here state a load without a unit there, or another unit.
const CURRENTS: [(u16, f64); 14] = [
    (311, 3.36e-3),
    (321, 3.36e-3),
    (1000, 2.69e-3),
    (1010, 2.69e-3),
    (1020, 2.69e-3),
    (1030, 2.69e-3),
    (1040, 2.69e-3),
    (1050, 2.69e-3),
    (1100, 2.69e-3),
    (1110, 2.69e-3),
    (1120, 2.69e-3),
    (1130, 2.69e-3),
    (1190, 1e-3),
    (1200, 1e-3),
];

/// A servo that is asked; it is never commanded.
#[derive(Debug)]
pub struct Dynamixel {
    id: u8,
    channels: Vec<Channel>,
    /// Number of the model, once it is known.
    model: Option<u16>,
    asking: Asking,
    packets: Packets,
    error: u8,
}

impl Dynamixel {
    /// The servo of this number (0 to 252), asked at this interval.
    ///
    /// # Errors
    /// When no servo has this number.
    pub fn new(id: u8, period_ns: i64) -> Result<Self> {
        if id > 252 {
            let problem = format!(
                "{id} is no number of a Dynamixel; expected 0 to 252, as in dynamixel:/dev/ttyUSB0?id=1"
            );
            return Err(crate::SourceError::Foreign(problem));
        }
        let channels = [
            ("position", Unit::Rad),
            ("speed", Unit::RadPerS),
            ("current", Unit::A),
            ("voltage", Unit::V),
            ("temperature", Unit::K),
            ("error", Unit::One),
        ];
        Ok(Self {
            id,
            channels: channels.iter().map(|(name, unit)| Channel::new(*name, *unit)).collect(),
            model: None,
            asking: Asking::new(period_ns),
            packets: Packets::default(),
            error: 0,
        })
    }

    fn question(&self) -> Vec<u8> {
        let (address, length) = if self.model.is_none() { MODEL } else { SAMPLE };
        read(self.id, address, length)
    }

    fn status(&mut self, status: &Status, arrival_ns: i64, heard: &mut Vec<Heard>) {
        if status.id != self.id {
            return;
        }
        if status.error & !ALERT != 0 {
            heard.push(Heard::Damaged("the servo refused the question"));
            return;
        }
        let error = status.error & ALERT;
        if error != self.error {
            self.error = error;
            if error != 0 {
                let text = "the Dynamixel reports a hardware error, which its register 70 names";
                heard.push(Heard::Fault(text.into()));
            }
        }
        match (self.model, &status.values[..]) {
            (None, &[low, high]) => {
                let model = u16::from_le_bytes([low, high]);
                self.model = Some(model);
                self.asking.answered(arrival_ns, Vec::new());
                if current_a(model).is_none() {
                    heard.push(Heard::Talk(format!(
                        "model {model}, whose measure of current has no known unit; it is left out"
                    )));
                }
            }
            (Some(model), values) => match row(model, values, error) {
                Some(row) => heard.push(self.asking.answered(arrival_ns, row)),
                None => heard.push(Heard::Damaged("an answer has another length than was asked for")),
            },
            (None, _) => heard.push(Heard::Damaged("an answer has another length than was asked for")),
        }
    }
}

/// The unit of the current of a model, A.
fn current_a(model: u16) -> Option<f64> {
    CURRENTS.iter().find(|(known, _)| *known == model).map(|(_, unit_a)| *unit_a)
}

/// Values of the registers of [`SAMPLE`].
fn row(model: u16, values: &[u8], error: u8) -> Option<Vec<f64>> {
    let [i0, i1, v0, v1, v2, v3, p0, p1, p2, p3, .., u0, u1, kelvin] = *values else { return None };
    if values.len() != usize::from(SAMPLE.1) {
        return None;
    }
    let current = f64::from(i16::from_le_bytes([i0, i1]));
    let speed = f64::from(i32::from_le_bytes([v0, v1, v2, v3]));
    let position = f64::from(i32::from_le_bytes([p0, p1, p2, p3]));
    Some(vec![
        position * TAU / POSITIONS,
        speed * SPEED_RPM * TAU / 60.0,
        current_a(model).map_or(f64::NAN, |unit_a| current * unit_a),
        f64::from(u16::from_le_bytes([u0, u1])) * 0.1,
        f64::from(kelvin) + ZERO_CELSIUS_K,
        f64::from(error),
    ])
}

impl Device for Dynamixel {
    fn kind(&self) -> String {
        format!("the Dynamixel {}, which is only asked", self.id)
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        Numbering::Arrival
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        self.asking.take_missing(heard);
        let mut packets = std::mem::take(&mut self.packets);
        packets.push(chunk, |packet, arrival_ns| match packet {
            Ok(status) => self.status(&status, arrival_ns, heard),
            Err(problem) => heard.push(Heard::Damaged(problem)),
        });
        self.packets = packets;
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        let question = self.question();
        Ok(Some(self.asking.poll(now_ns, &question, out)))
    }

    fn awaits(&self) -> bool {
        self.asking.awaits()
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        self.asking.interrupted(self.packets.interrupt(), heard);
    }
}
