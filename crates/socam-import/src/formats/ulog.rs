//! ULog of PX4 (`.ulg`): each topic, and each instance of one, is a group (PX4, "ULog File Format", version 1).

mod layout;

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use socam_recording::Warning;

use self::layout::{Field, Formats};
use super::stream::{Fields, Problem, Stream};
use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

/// Bytes of the message by which a reader finds its way again: length, type and magic.
const SYNC: [u8; 11] = [8, 0, b'S', 0x2f, 0x73, 0x13, 0x20, 0x25, 0x0c, 0xbb, 0x12];
/// Types of messages that the description knows.
const TYPES: &[u8] = b"BFIMPQARDLCSO";
/// Most topics, and most signals of all of them: a log of PX4 has some hundred and some thousand.
const MOST_TOPICS: usize = 2048;
const MOST_SIGNALS: usize = 1 << 17;
/// The clock of a topic.
const TIME: &str = "timestamp";
/// Ends of names that PX4 gives volts and amperes.
const CONVENTION: [(&str, &str); 2] =
    [("_v", "by the convention of PX4 \"V\""), ("_a", "by the convention of PX4 \"A\"")];

/// A topic while its messages are read.
struct Topic {
    name: String,
    fields: Vec<Field>,
    columns: Vec<Signal>,
    rows: usize,
}

struct Log<'w> {
    wanted: &'w Wanted,
    formats: Formats,
    topics: BTreeMap<u16, Topic>,
    /// Numbers of topics that are left aside.
    refused: HashSet<u16>,
    /// Signals of all topics so far.
    signals: usize,
    /// Where data that were appended after a crash begin, bytes.
    appended: Vec<u64>,
    damaged: usize,
    dropouts: usize,
    dropped_ms: u64,
    notes: Vec<Warning>,
}

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let mut stream = Stream::open(path)?;
    let mut log = Log {
        wanted,
        formats: Formats::default(),
        topics: BTreeMap::new(),
        refused: HashSet::new(),
        signals: 0,
        appended: Vec::new(),
        damaged: 0,
        dropouts: 0,
        dropped_ms: 0,
        notes: Vec::new(),
    };
    let read = stream.exactly(16).map(drop).and_then(|()| log.messages(&mut stream));
    let rows: usize = log.topics.values().map(|topic| topic.rows).sum();
    match read {
        Err(problem) if rows == 0 => return Err(ImportError::damaged(path, problem)),
        Err(problem) => {
            let what = format!("messages after {rows} are missing ({problem})");
            log.notes.push(Warning::Incomplete { what });
        }
        Ok(()) => {}
    }
    Ok(log.finish())
}

impl Log<'_> {
    fn messages(&mut self, stream: &mut Stream) -> Result<(), Problem> {
        loop {
            let from = stream.at;
            self.appended.retain(|at| *at > from);
            let end = self.appended.first().copied();
            let head = stream.up_to(3)?;
            let Some(&[low, high, kind]) = head.first_chunk() else {
                return if head.is_empty() {
                    Ok(())
                } else {
                    Err(format!("a message at byte {from} is cut off"))
                };
            };
            let size = u16::from_le_bytes([low, high]);
            let next = stream.at + u64::from(size);
            if let Some(end) = end.filter(|end| *end < next) {
                // The crash cut the last message before what was appended.
                stream.go_to(end)?;
                continue;
            }
            if !TYPES.contains(&kind) || size == 0 {
                self.find_way(stream, from)?;
                continue;
            }
            let payload = stream.exactly(usize::from(size))?;
            self.message(kind, payload)?;
        }
    }

    fn message(&mut self, kind: u8, payload: &[u8]) -> Result<(), Problem> {
        let mut fields = Fields(payload);
        match kind {
            b'B' => self.flags(&mut fields)?,
            b'F' => self.formats.add(&String::from_utf8_lossy(payload)),
            b'A' => {
                let head = fields.u8().zip(fields.u16());
                let (instance, id) = head.ok_or("a topic is announced without its number")?;
                self.announce(id, instance, &String::from_utf8_lossy(fields.0));
            }
            b'D' => {
                let id = fields.u16();
                match id.and_then(|id| self.topics.get_mut(&id)) {
                    Some(topic) if topic.rows >= self.wanted.most_rows => {}
                    Some(topic) => self.damaged += usize::from(topic.push(fields.0).is_none()),
                    None if id.is_some_and(|id| self.refused.contains(&id)) => {}
                    None => self.damaged += 1,
                }
            }
            b'O' => {
                self.dropouts += 1;
                self.dropped_ms += u64::from(fields.u16().unwrap_or(0));
            }
            _ => {}
        }
        Ok(())
    }

    /// What the file uses of the format.
    fn flags(&mut self, fields: &mut Fields<'_>) -> Result<(), Problem> {
        let flags = fields.bytes(8).and_then(|_| fields.bytes(8)).ok_or("its flags are cut off")?;
        if flags[0] & !1 != 0 || flags[1..].iter().any(|byte| *byte != 0) {
            return Err("it uses parts of ULog that are not known here".into());
        }
        self.appended = (0..3).filter_map(|_| fields.u64()).filter(|at| *at > 0).collect();
        self.appended.sort_unstable();
        Ok(())
    }

    fn announce(&mut self, id: u16, instance: u8, topic: &str) {
        if self.topics.contains_key(&id)
            || self.refused.contains(&id)
            || self.topics.len() + self.refused.len() >= MOST_TOPICS
        {
            return;
        }
        let name = if instance == 0 { topic.to_owned() } else { format!("{topic}.{instance}") };
        match self.formats.fields(topic) {
            Ok(fields) if fields.iter().any(|field| field.path == TIME) && self.signals < MOST_SIGNALS => {
                let wanted = |field: &Field| field.path == TIME || self.wanted.takes(&name, &field.path);
                let fields: Vec<Field> = fields.into_iter().filter(wanted).collect();
                let columns = fields.iter().map(|field| field.signal()).collect();
                self.signals += fields.len();
                self.topics.insert(id, Topic { name, fields, columns, rows: 0 });
            }
            refused => {
                let why =
                    refused.err().unwrap_or_else(|| format!("it has no `{TIME}`, or is one of too many"));
                self.refused.insert(id);
                self.notes.push(Warning::Note(format!("topic `{name}` is left aside: {why}")));
            }
        }
    }

    /// Goes to the next message of synchronisation behind a damaged place.
    fn find_way(&mut self, stream: &mut Stream, from: u64) -> Result<(), Problem> {
        const PIECE: usize = 1 << 16;
        let mut at = from + 1;
        loop {
            stream.go_to(at)?;
            let piece = stream.up_to(PIECE)?;
            if let Some(found) = piece.windows(SYNC.len()).position(|bytes| bytes == SYNC) {
                let to = at + found as u64;
                let what = format!("bytes {from} to {to} are damaged and were passed over");
                self.notes.push(Warning::Incomplete { what });
                return stream.go_to(to);
            }
            if piece.len() < PIECE {
                return Err(format!("the message at byte {from} is of no known type"));
            }
            at += (PIECE - SYNC.len()) as u64;
        }
    }

    fn finish(mut self) -> Source {
        if self.dropouts > 0 {
            let (count, ms) = (self.dropouts, self.dropped_ms);
            self.notes.push(Warning::Note(format!(
                "the vehicle could not write {count} times, {ms} ms in all: samples are missing there"
            )));
        }
        if self.damaged > 0 {
            let problem = format!(
                "{} messages are of no topic, or shorter than it says, and are left aside",
                self.damaged
            );
            self.notes.push(Warning::Note(problem));
        }
        let topics = self.topics.into_values().filter(|topic| topic.rows > 0 && topic.columns.len() > 1);
        Source { groups: topics.map(Topic::group).collect(), notes: self.notes, ..Source::default() }.tidy()
    }
}

impl Topic {
    /// Puts a message into a new row; `None` where it is too short.
    fn push(&mut self, data: &[u8]) -> Option<()> {
        let last = self.fields.iter().map(|field| field.at + field.kind.bytes()).max()?;
        if data.len() < last {
            return None;
        }
        for (field, column) in self.fields.iter().zip(&mut self.columns) {
            field.push(data, column)?;
        }
        self.rows += 1;
        Some(())
    }

    fn group(self) -> Group {
        let hint = |name: &str| CONVENTION.iter().find(|(end, _)| name.ends_with(end)).map(|(_, hint)| *hint);
        let named = |signal: Signal| Signal { hint: hint(&signal.name), ..signal };
        let time = self.columns.iter().position(|column| column.name == TIME);
        let signals = self.columns.into_iter().map(named).collect();
        Group { name: self.name, signals, time, is_by_arrival: true }
    }
}
