//! A drive on a CAN bus by CANopen (CiA 301 and 402). [`Canopen`] only reads: nothing is sent to it but questions for objects and, if the list of
//! objects says so, SYNC. [`CanopenDrive`] obeys orders as well, where the list marks it.
//!
//! Objects that the drive sends in PDOs are taken from these, as the drive itself is configured; all others are asked for by SDO, one after
//! the other, once a row.

mod commands;
mod control;
mod discovery;
mod messages;
mod obeying;
mod objects;
mod place;
mod preparation;
mod requests;
mod settings;
mod watched;

use socam_recording::Channel;

use super::adapter::Adapter;
use super::others::Others;
use super::slcan::CanFrame;
use crate::asking::{Asking, UNASKED};
use crate::device::{Chunk, Device, Heard, Numbering, Row};
use crate::error::{Result, SourceError};
use crate::silence::Silence;
use discovery::{Discovery, Pdo, is_held};
use messages::{
    Answer, Kind, LARGEST_NODE, STATUSWORD, kind, node_of, state_of_drive, state_of_node, sync, upload,
};
pub use obeying::CanopenDrive;
pub use objects::{Objects, SCHEMA};
use requests::Requests;

/// A drive.
#[derive(Debug)]
pub struct Canopen {
    node: u8,
    objects: Objects,
    channels: Vec<Channel>,
    adapter: Adapter,
    asking: Asking,
    /// Until it is known how the drive is configured.
    discovery: Option<Discovery>,
    pdos: Vec<Pdo>,
    /// Objects that are asked for by SDO, and how many of them have answered.
    asked: Vec<usize>,
    answered: usize,
    /// Whether the next of them is to be asked for.
    is_next_due: bool,
    /// What a question carries before them.
    requests: Requests,
    /// Values since the last row.
    values: Vec<f64>,
    /// PDOs that have arrived since the last row.
    arrived: Vec<bool>,
    /// State of the drive, the node, and its last emergency.
    drive: Option<&'static str>,
    state: Option<&'static str>,
    emergency: u16,
    /// Since the last row.
    silence: Silence,
    others: Others,
    /// Why it can no longer be used.
    failed: Option<SourceError>,
}

impl Canopen {
    /// The drive of a number with a list of its objects, asked at this interval. These commands open its adapter, with
    /// [`super::Access::Send`].
    ///
    /// # Errors
    /// When no node has this number.
    pub fn new(node: u8, objects: Objects, period_ns: i64, opening: Vec<u8>) -> Result<Self> {
        if node == 0 || node > LARGEST_NODE {
            let problem = format!(
                "{node} is no node of CANopen; expected 1 to {LARGEST_NODE}, as in canopen+socketcan:can0?node=5"
            );
            return Err(SourceError::Foreign(problem));
        }
        Ok(Self {
            node,
            channels: objects.channels(),
            adapter: Adapter::closed(opening),
            asking: Asking::new(period_ns),
            discovery: Some(Discovery::new(node)),
            pdos: Vec::new(),
            asked: Vec::new(),
            answered: 0,
            is_next_due: false,
            requests: Requests::default(),
            values: vec![f64::NAN; objects.all.len()],
            objects,
            arrived: Vec::new(),
            drive: None,
            state: None,
            emergency: 0,
            silence: Silence::default(),
            others: Others::default(),
            failed: None,
        })
    }

    /// Whether PDOs alone make the rows, at the drive's own rhythm.
    fn is_free(&self) -> bool {
        self.asked.is_empty() && !self.objects.is_synced && !self.requests.is_commanded
    }

    fn configured(&mut self, pdos: Vec<Pdo>, heard: &mut Vec<Heard>) {
        self.asked = (0..self.objects.all.len()).filter(|index| !is_held(&pdos, *index)).collect();
        let names: Vec<String> = self.asked.iter().map(|index| self.objects.all[*index].name()).collect();
        let ids: Vec<String> = pdos.iter().map(|pdo| format!("{:X}", pdo.id)).collect();
        let by = |what: &str, all: &[String]| {
            if all.is_empty() { String::new() } else { format!("; {what} {}", all.join(", ")) }
        };
        heard.push(Heard::Talk(format!(
            "objects are read{}{}",
            by("by the PDOs", &ids),
            by("by SDO:", &names)
        )));
        self.arrived = vec![false; pdos.len()];
        self.pdos = pdos;
    }

    fn frame(&mut self, frame: &CanFrame, arrival_ns: i64, heard: &mut Vec<Heard>) {
        if frame.is_extended {
            return;
        }
        match kind(frame.id, self.node) {
            Kind::Answer => self.answer(&frame.bytes, arrival_ns, heard),
            Kind::Emergency => self.emergency(&frame.bytes, heard),
            Kind::Heartbeat => {
                let state = frame.bytes.first().map(|byte| state_of_node(*byte));
                if let Some(state) = state.filter(|state| self.state != Some(*state)) {
                    self.state = Some(state);
                    heard.push(Heard::Talk(format!("the node is {state}")));
                }
            }
            Kind::Other => {
                let rival = self.requests.heard(frame.id, &frame.bytes, self.node);
                heard.extend(rival.map(Heard::Fault));
                self.pdo(frame, arrival_ns, heard);
            }
        }
    }

    fn emergency(&mut self, bytes: &[u8], heard: &mut Vec<Heard>) {
        let [low, high, register, ..] = *bytes else {
            heard.push(Heard::Damaged("an emergency message is too short"));
            return;
        };
        let code = u16::from_le_bytes([low, high]);
        if std::mem::replace(&mut self.emergency, code) == code {
            return;
        }
        heard.push(match code {
            0 => Heard::Talk("its emergency is over".into()),
            code if self.requests.is_tried => Heard::Talk(format!(
                "the drive reports emergency {code:04X} while its heartbeat is tried, as expected"
            )),
            code => Heard::Fault(format!(
                "the drive reports emergency {code:04X} (error register {register:02X})"
            )),
        });
    }

    fn answer(&mut self, bytes: &[u8], arrival_ns: i64, heard: &mut Vec<Heard>) {
        let answer = match Answer::read(bytes) {
            Ok(answer) => answer,
            Err(problem) => {
                heard.push(Heard::Damaged(problem));
                return;
            }
        };
        if let Some(discovery) = &mut self.discovery {
            if let Err(error) = discovery.take(&answer, &self.objects) {
                self.failed = Some(error);
            } else if let Some(pdos) = discovery.done() {
                self.discovery = None;
                self.configured(pdos, heard);
            }
            return;
        }
        let is_awaited = self.asking.awaits() && !self.is_next_due;
        if !(is_awaited && (self.requests.take(&answer) || self.object(&answer, heard))) {
            self.asking.late(arrival_ns);
            let is_written = matches!(answer, Answer::Done(_));
            heard.push(Heard::Damaged(if is_written {
                UNASKED
            } else {
                "an answer of SDO came that was not asked for"
            }));
            return;
        }
        self.is_next_due = self.next_line().is_some();
        self.row(arrival_ns, heard);
    }

    /// Takes the answer for the object that is waited for; `false` if it is none.
    fn object(&mut self, answer: &Answer, heard: &mut Vec<Heard>) -> bool {
        let wanted = self.asked.get(self.answered).copied().filter(|_| self.requests.front().is_none());
        let Some(index) = wanted.filter(|index| self.objects.all[*index].place == answer.place()) else {
            return false;
        };
        match answer {
            Answer::Value(_, bytes) => self.value(index, bytes, heard),
            Answer::Done(_) => return false,
            Answer::Abort(..) | Answer::Long(_) => heard.push(Heard::Damaged("the drive refused an object")),
        }
        self.answered += 1;
        true
    }

    /// The next transfer of the present question.
    fn next_line(&self) -> Option<Vec<u8>> {
        let object = || Some(upload(self.node, self.objects.all[*self.asked.get(self.answered)?].place));
        self.requests.front().map(|request| request.line(self.node)).or_else(object)
    }

    fn pdo(&mut self, frame: &CanFrame, arrival_ns: i64, heard: &mut Vec<Heard>) {
        let Some(number) = self.pdos.iter().position(|pdo| pdo.id == frame.id) else {
            if let Some(node) = node_of(frame.id).filter(|node| *node != u32::from(self.node)) {
                self.others.heard(node);
            }
            return;
        };
        if frame.bytes.len() != self.pdos[number].length {
            heard.push(Heard::Damaged("a PDO has another length than the drive's mapping"));
            return;
        }
        for held in 0..self.pdos[number].places.len() {
            let (index, begin) = self.pdos[number].places[held];
            let width = self.objects.all[index].number.width();
            if let Some(bytes) = frame.bytes.get(begin..begin + width) {
                self.value(index, bytes, heard);
            }
        }
        self.arrived[number] = true;
        // The first PDO that holds any object gives the rows.
        if self.is_free() && number == 0 {
            let values = self.take_values();
            self.silence.heard(arrival_ns);
            heard.push(Heard::Row(Row { device_s: None, number: None, arrival_ns, spread_ns: 0, values }));
        } else {
            self.row(arrival_ns, heard);
        }
    }

    fn value(&mut self, index: usize, bytes: &[u8], heard: &mut Vec<Heard>) {
        let object = &mut self.objects.all[index];
        match object.si(bytes) {
            Ok(value) => self.values[index] = value,
            Err(problem) => {
                heard.push(Heard::Damaged(problem));
                return;
            }
        }
        if object.place == STATUSWORD {
            let word = object.raw(bytes) as u16;
            let (state, is_fault) = state_of_drive(word);
            self.requests.stated(word, is_fault);
            let is_fault = is_fault && !self.requests.is_tried;
            if self.drive.replace(state) != Some(state) {
                let text = format!("the drive is {state}");
                heard.push(if is_fault { Heard::Fault(text) } else { Heard::Talk(text) });
            }
        }
    }

    fn take_values(&mut self) -> Vec<f64> {
        self.arrived.fill(false);
        std::mem::replace(&mut self.values, vec![f64::NAN; self.objects.all.len()])
    }

    /// Hands on the row that was asked for, once all of it has arrived.
    fn row(&mut self, arrival_ns: i64, heard: &mut Vec<Heard>) {
        let is_whole = self.answered == self.asked.len()
            && self.requests.front().is_none()
            && (!self.objects.is_synced || self.arrived.iter().all(|arrived| *arrived));
        if !self.is_free() && is_whole && self.asking.awaits() {
            let values = self.take_values();
            self.silence.heard(arrival_ns);
            heard.push(self.asking.answered(arrival_ns, values));
        }
    }

    fn silent(&self) -> SourceError {
        let why = match (self.state, self.pdos.is_empty()) {
            (Some(state), false) if state != "operational" => {
                format!("it is {state} and sends no PDO: its master has to start it")
            }
            (_, false) => "its PDOs do not arrive: has its master started it, and do they wait for SYNC (`sync = true`)?".into(),
            _ => self.others.names().map_or_else(
                || "is the bus running?".into(),
                |others| format!("frames of nodes {others} arrive"),
            ),
        };
        let problem = format!("node {} has given no row for {} s: {why}", self.node, Silence::MOST_S);
        SourceError::Foreign(problem)
    }
}

impl Device for Canopen {
    fn kind(&self) -> String {
        format!("node {} of a CAN bus, a drive with CANopen, which is only read", self.node)
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
        frames.iter().for_each(|(frame, arrival_ns)| self.frame(frame, *arrival_ns, heard));
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        let flags_ns = self.adapter.poll(now_ns, out);
        if let Some(discovery) = &mut self.discovery {
            self.silence.heard(now_ns);
            return Ok(Some(discovery.poll(now_ns, &self.objects, out)?.min(flags_ns)));
        }
        if self.silence.is_too_long(now_ns) {
            return Err(self.silent());
        }
        if self.is_free() {
            return Ok(Some(flags_ns));
        }
        if let Some(next_ns) = self.asking.wait(now_ns) {
            if std::mem::take(&mut self.is_next_due) {
                out.extend(self.next_line().unwrap_or_default());
            }
            return Ok(Some(next_ns.min(flags_ns)));
        }
        (self.answered, self.is_next_due) = (0, false);
        self.requests.begin();
        let sync = if self.objects.is_synced { sync() } else { Vec::new() };
        let question = [self.requests.heartbeat.clone(), sync, self.next_line().unwrap_or_default()].concat();
        if self.objects.is_synced {
            self.take_values();
        }
        Ok(Some(self.asking.poll(now_ns, &question, out).min(flags_ns)))
    }

    /// What is sent between questions waits until the next one.
    fn awaits(&self) -> bool {
        self.discovery.is_some() || self.is_free() || self.asking.awaits()
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        self.take_values();
        (self.answered, self.is_next_due) = (0, false);
        self.requests.interrupted();
        self.asking.interrupted(false, heard);
        self.adapter.interrupted(heard);
    }
}
