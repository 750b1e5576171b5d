//! A moteus servo drive behind an fdcanusb, which sends frames of CAN FD as lines of text. It is asked for each sample, and
//! commanded by [`crate::Commanded`] alone.

mod orders;
mod registers;

use std::f64::consts::TAU;

use moteus_protocol::fdcanusb::{self, Line};
use moteus_protocol::{CanFdFrame, Register, parse_arbitration_id, scaling};
use socam_recording::Channel;
use socam_units::Unit;

use crate::ZERO_CELSIUS_K;
use crate::asking::Asking;
use crate::device::{Chunk, Device, Heard, Numbering};
use crate::drive::{Commands, Drive, Limits, Order, Readiness, Standing, Watched};
use crate::error::Result;
use crate::text::lines::Lines;
use orders::{fault_name, line, mode_name};
use registers::registers;

/// Modes of a drive: off, in a fault, and obeying.
const STOPPED: f64 = 0.0;
const FAULT: f64 = 1.0;
const POSITION: f64 = 10.0;

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

/// A drive that is asked. As a [`Drive`] it obeys orders.
#[derive(Debug)]
pub struct Moteus {
    id: u8,
    channels: Vec<Channel>,
    question: Vec<u8>,
    limits: Option<Limits>,
    /// Mode and fault of the last answer.
    last: Option<(f64, f64)>,
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
            question: line(id, Order::Ask, None),
            limits: None,
            last: None,
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
        self.last = Some((values[0], values[7]));
        let fault = Some(values[7]).filter(|_| values[0] == FAULT);
        if fault != self.fault {
            self.fault = fault;
            heard.extend(fault.map(|code| Heard::Fault(fault_text(code))));
        }
        Ok(Some(values))
    }
}

fn fault_text(code: f64) -> String {
    format!("the moteus reports fault {code} ({})", fault_name(code))
}

impl Drive for Moteus {
    fn watched(&self) -> Watched {
        Watched { speed: 2, effort: 3, position: Some(1) }
    }

    fn limit(&mut self, limits: Limits) {
        self.limits = Some(limits);
    }

    fn order(&mut self, order: Order) {
        self.question = self.bytes(order);
    }

    fn bytes(&self, order: Order) -> Vec<u8> {
        line(self.id, order, self.limits)
    }

    fn standing(&self) -> Standing {
        match self.last {
            Some((STOPPED, _)) => Standing::Stopped,
            Some((POSITION, _)) => Standing::Obeying,
            Some((FAULT, code)) => Standing::Fault(fault_text(code)),
            Some((mode, _)) => Standing::Other(mode_name(mode)),
            None => Standing::Other("silent".into()),
        }
    }

    /// The limits are part of each command, so that nothing is to be prepared.
    fn readiness(&self) -> Readiness {
        if self.limits.is_some() { Readiness::Ready } else { Readiness::Pending }
    }

    fn promises(&self) -> [Vec<String>; 2] {
        let Some(limits) = self.limits else { return [Vec::new(), Vec::new()] };
        let mut kept = vec![format!("Each command holds a largest torque of {} N m.", limits.effort)];
        let mut not_promised = Vec::new();
        match limits.commands {
            Commands::Speeds => kept.push(format!(
                "Each command holds a largest speed of {} rad/s for what is aimed at, and a largest acceleration of {} rad/s2.",
                limits.speed_rad_s, limits.acceleration_rad_s2
            )),
            Commands::Torques => not_promised.extend([
                format!(
                    "Under a torque the drive limits its speed by its setting `servo.max_velocity` alone, which is not read here and is far above most limits by default: this computer stops it where it states more than {} rad/s, and without this computer it turns faster until its watchdog acts, by up to the largest torque times {} s over the inertia.",
                    limits.speed_rad_s, limits.watchdog_s
                ),
                "A drive whose `servo.pid_position.ilimit` is not 0, its default, adds a torque of its own, within the largest torque.".into(),
            ]),
        }
        kept.push(format!(
            "Each command holds a watchdog: the drive leaves its position mode {} s after the last command that it got.",
            limits.watchdog_s
        ));
        not_promised.extend([

                "Once its watchdog has acted, it does what its setting `servo.timeout_mode` says, by default braking with up to `servo.timeout_max_torque_Nm`, 5 N m by default; it cannot be read here.".into(),
                "It does not limit the speed that a load drives it to: this computer ends the run when a speed beyond the limit is measured.".into(),
                "When the run ends the motor is switched off: it coasts, and a weight falls.".into(),
        ]);
        [kept, not_promised]
    }
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
        self.asking.interrupted(self.lines.interrupt(), heard);
    }
}
