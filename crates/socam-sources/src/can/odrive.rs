//! An ODrive on a CAN bus, by its protocol CAN Simple. It is asked for each sample, and commanded by [`crate::Commanded`] alone.
//!
//! Each question asks by RTR for position and speed, current, and supply; those that the drive sends by itself (cyclic messages) are taken as
//! answers, because they are measured as they are sent. Heartbeats are never asked for: firmware 0.5 only sends them by itself.

mod message;
mod obeying;
mod trial;

use std::f64::consts::TAU;

use socam_recording::Channel;
use socam_units::Unit;

use super::adapter::Adapter;
use super::others::Others;
use super::slcan::CanFrame;
use crate::ZERO_CELSIUS_K;
use crate::asking::Asking;
use crate::device::{Chunk, Device, Heard, Numbering};
use crate::drive::{Drive, Limits, Order};
use crate::error::{Result, SourceError};
use crate::odrive::Generation;
use crate::silence::Silence;
use message::{LARGEST_NODE, Message, To, node_and_number, read};
use trial::Trial;

/// Questions between those for temperatures.
const TEMPERATURES_EVERY: u64 = 20;
/// Time for an answer about the firmware, which only 0.6 gives, and how often it is asked for.
const VERSION_NS: i64 = 50_000_000;
const VERSION_ASKED: u8 = 3;

/// An ODrive that is asked. As a [`Drive`] it obeys orders.
#[derive(Debug)]
pub struct OdriveCan {
    to: To,
    channels: Vec<Channel>,
    adapter: Adapter,
    asking: Asking,
    firmware: Firmware,
    sample: Sample,
    questions: u64,
    /// Arrival, error and state of the last heartbeat.
    heartbeat: Option<(i64, u64, u8)>,
    /// Time between the last two heartbeats, ns.
    interval_ns: i64,
    /// Whether another host commands the drive.
    has_rival: bool,
    order: Order,
    is_begun: bool,
    limits: Option<Limits>,
    trial: Trial,
    /// Since the last row, and whether a frame of the node has arrived since then.
    silence: Silence,
    is_heard: bool,
    others: Others,
    now_ns: i64,
}

/// What is known of the firmware.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Firmware {
    /// It was asked for as often, the last time at this time.
    Asked(u8, i64),
    Known(Generation),
}

/// What has arrived since the last row.
#[derive(Debug, Default)]
struct Sample {
    encoder: Option<(f64, f64)>,
    current_a: Option<f64>,
    supply: Option<(f64, f64)>,
    temperatures: Option<(f64, f64)>,
    error: Option<u64>,
}

impl OdriveCan {
    /// The drive of a number, asked at this interval. These commands open its adapter, with [`super::Access::Send`].
    ///
    /// # Errors
    /// When no node has this number.
    pub fn new(node: u8, period_ns: i64, opening: Vec<u8>) -> Result<Self> {
        if node > LARGEST_NODE {
            let problem = format!(
                "{node} is no node of an ODrive; expected 0 to {LARGEST_NODE}, as in odrive+socketcan:can0?node=1"
            );
            return Err(SourceError::Foreign(problem));
        }
        let channels = [
            ("position", Unit::Rad),
            ("speed", Unit::RadPerS),
            ("current", Unit::A),
            ("voltage", Unit::V),
            ("supply_current", Unit::A),
            ("temperature", Unit::K),
            ("motor_temperature", Unit::K),
            ("error", Unit::One),
        ];
        Ok(Self {
            to: To(node),
            channels: channels.iter().map(|(name, unit)| Channel::new(*name, *unit)).collect(),
            adapter: Adapter::closed(opening),
            asking: Asking::new(period_ns),
            firmware: Firmware::Asked(0, i64::MIN),
            sample: Sample::default(),
            questions: 0,
            heartbeat: None,
            interval_ns: 0,
            has_rival: false,
            order: Order::Ask,
            is_begun: false,
            limits: None,
            trial: Trial::Waiting,
            silence: Silence::default(),
            is_heard: false,
            others: Others::default(),
            now_ns: 0,
        })
    }

    fn generation(&self) -> Generation {
        if let Firmware::Known(generation) = self.firmware { generation } else { Generation::Early }
    }

    fn frame(&mut self, frame: &CanFrame, arrival_ns: i64, heard: &mut Vec<Heard>) {
        let (node, number) = node_and_number(frame.id);
        if frame.is_extended || node != u32::from(self.to.0) {
            if !frame.is_extended {
                self.others.heard(node);
            }
            return;
        }
        match read(number, &frame.bytes, self.generation()) {
            Err(problem) => {
                self.is_heard = true;
                heard.push(Heard::Damaged(problem));
            }
            Ok(None) => {}
            Ok(Some(message)) => {
                self.is_heard = true;
                self.take(message, arrival_ns, heard);
            }
        }
    }

    fn take(&mut self, message: Message, arrival_ns: i64, heard: &mut Vec<Heard>) {
        match message {
            Message::Version([major, minor, revision]) => {
                let is_late = (major, minor) >= (0, 6);
                let known = Firmware::Known(if is_late { Generation::Late } else { Generation::Early });
                if std::mem::replace(&mut self.firmware, known) != known {
                    heard.push(Heard::Talk(format!("firmware {major}.{minor}.{revision}")));
                }
            }
            Message::Heartbeat { error, state } => self.beats(u64::from(error), state, arrival_ns, heard),
            Message::Encoder(turns, turns_s) => self.sample.encoder = Some((turns, turns_s)),
            Message::Current(current_a) => self.sample.current_a = Some(current_a),
            Message::Supply(voltage_v, current_a) => self.sample.supply = Some((voltage_v, current_a)),
            Message::Temperature(inverter, motor) => self.sample.temperatures = Some((inverter, motor)),
            Message::Command => {
                if !std::mem::replace(&mut self.has_rival, true) {
                    heard.push(Heard::Fault("another program on the bus commands this ODrive".into()));
                }
            }
        }
        if self.asking.awaits() {
            self.row(arrival_ns, heard);
        } else if matches!(message, Message::Current(_) | Message::Supply(..)) {
            // Positions are usually sent unasked too, these are not.
            self.asking.late(arrival_ns);
        }
    }

    /// Hands on a row once all of it has arrived.
    fn row(&mut self, arrival_ns: i64, heard: &mut Vec<Heard>) {
        let Sample {
            encoder: Some((turns, turns_s)), current_a: Some(current_a), supply: Some(supply), ..
        } = self.sample
        else {
            return;
        };
        let sample = std::mem::take(&mut self.sample);
        // A motor without a sensor states no number, or 0 K.
        let kelvin = |celsius: f64| if celsius.is_finite() { celsius + ZERO_CELSIUS_K } else { f64::NAN };
        let (inverter, motor) = sample.temperatures.unwrap_or((f64::NAN, f64::NAN));
        let error = sample.error.map_or(f64::NAN, |error| error as f64);
        let values = vec![
            turns * TAU,
            turns_s * TAU,
            current_a,
            supply.0,
            supply.1,
            kelvin(inverter),
            kelvin(motor),
            error,
        ];
        self.silence.heard(arrival_ns);
        self.is_heard = false;
        heard.push(self.asking.answered(arrival_ns, values));
    }

    fn beats(&mut self, error: u64, state: u8, arrival_ns: i64, heard: &mut Vec<Heard>) {
        let before = self.heartbeat.map_or(0, |(_, error, _)| error);
        let generation = self.generation();
        if let Some((last_ns, ..)) = self.heartbeat.replace((arrival_ns, error, state)) {
            self.interval_ns = arrival_ns.saturating_sub(last_ns);
        }
        self.sample.error = Some(error);
        let is_expected =
            self.limits.is_some() && self.trial.expects_expiry() && error == generation.watchdog();
        if let Some(limits) = self.limits {
            self.trial.passes(arrival_ns, limits.watchdog_s, self.interval_ns);
            self.trial.heartbeat(arrival_ns, error, generation);
        }
        if error != before && error != 0 && !is_expected {
            heard.push(Heard::Fault(generation.fault_text(error)));
        }
    }

    /// Asks for the firmware, until it is known or has not answered.
    fn ask_version(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Option<i64> {
        let Firmware::Asked(times, last_ns) = self.firmware else { return None };
        let due_ns = last_ns.saturating_add(VERSION_NS);
        if now_ns < due_ns {
            return Some(due_ns);
        }
        if times >= VERSION_ASKED {
            self.firmware = Firmware::Known(Generation::Early);
            return None;
        }
        out.extend(self.to.version());
        self.firmware = Firmware::Asked(times + 1, now_ns);
        Some(now_ns.saturating_add(VERSION_NS))
    }

    fn silent(&self) -> SourceError {
        let (node, waited_s) = (self.to.0, Silence::MOST_S);
        if self.is_heard {
            let problem = format!(
                "node {node} sends frames, and has not answered whole for {waited_s} s: is it an ODrive, and may questions (RTR) pass?"
            );
            return SourceError::Foreign(problem);
        }
        let heard = self.others.names().map_or_else(
            || "no frame of any node arrives: is the bus running, is the bit rate right, and is it terminated?".into(),
            |others| format!("frames like those of nodes {others} arrive: is its `config.can.node_id` another?"),
        );
        let problem = format!("node {node} has said nothing for {waited_s} s; {heard}");
        SourceError::Foreign(problem)
    }
}

impl Device for OdriveCan {
    fn kind(&self) -> String {
        format!("node {} of a CAN bus, an ODrive, which is only asked", self.to.0)
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        Numbering::Arrival
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        self.asking.take_missing(heard);
        let frames = self.adapter.receive(chunk, heard);
        for (frame, arrival_ns) in &frames {
            self.now_ns = self.now_ns.max(*arrival_ns);
            self.frame(frame, *arrival_ns, heard);
        }
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        self.now_ns = now_ns;
        if self.silence.is_too_long(now_ns) {
            return Err(self.silent());
        }
        let flags_ns = self.adapter.poll(now_ns, out);
        if let Some(due_ns) = self.ask_version(now_ns, out) {
            return Ok(Some(due_ns.min(flags_ns)));
        }
        if let Some(limits) = self.limits {
            self.trial.passes(now_ns, limits.watchdog_s, self.interval_ns);
        }
        if matches!(self.trial, Trial::Silent { .. }) && self.order == Order::Prepare {
            return Ok(Some(now_ns + VERSION_NS));
        }
        if let Some(next_ns) = self.asking.wait(now_ns) {
            return Ok(Some(next_ns));
        }
        let question = self.bytes(self.order);
        let Sample { temperatures, error, .. } = self.sample;
        self.sample = Sample { temperatures, error, ..Sample::default() };
        self.questions += 1;
        self.is_begun |= matches!(self.order, Order::Speed(_) | Order::Torque(_));
        Ok(Some(self.asking.poll(now_ns, &question, out)))
    }

    /// What is sent between questions waits until the next one.
    fn awaits(&self) -> bool {
        let is_listening =
            matches!(self.firmware, Firmware::Asked(..)) || matches!(self.trial, Trial::Silent { .. });
        self.asking.awaits() || is_listening
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        self.sample = Sample::default();
        self.asking.interrupted(false, heard);
        self.adapter.interrupted(heard);
    }
}
