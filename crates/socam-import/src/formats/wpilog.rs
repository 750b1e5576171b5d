//! WPILOG of WPILib and AdvantageKit (`.wpilog`): entries with times of their own (WPILib, "WPILib Data Log File Format Specification", version 1.0).

mod units;

use std::collections::HashMap;
use std::path::Path;

use socam_recording::Warning;

use super::stream::{Fields, Problem, Stream, left_aside};
use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};
use units::unit;

/// Longest record that is read, bytes.
const LONGEST_RECORD: u64 = 1 << 26;
/// Name of an entry's clock.
const TIME: &str = "timestamp";
/// Longest array whose elements are signals.
const LONGEST_ARRAY: usize = 64;
/// Entries with this beginning hold the state of SysId's tests: `quasistatic-forward`, or `none` between them.
const SYSID_STATE: &str = "sysid-test-state";

/// What a number is written as.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Boolean,
    Int64,
    Float,
    Double,
}

#[derive(Debug)]
struct Entry {
    name: String,
    kind: Kind,
    is_array: bool,
    unit: Option<String>,
    is_wanted: bool,
    time: Signal,
    columns: Vec<Signal>,
}

/// What an entry's number stands for.
#[derive(Debug, Clone, Copy)]
enum Place {
    Entry(usize),
    /// The state of SysId's tests.
    State,
    Other,
}

struct Log<'w> {
    wanted: &'w Wanted,
    places: HashMap<u32, Place>,
    entries: Vec<Entry>,
    /// Index of each entry by name and type: one that was finished may be started again by another number.
    known: HashMap<(String, String), usize>,
    others: Vec<String>,
    damaged: usize,
    /// Times and names of states, s.
    states: Vec<(f64, String)>,
}

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let mut stream = Stream::open(path)?;
    let mut log = Log {
        wanted,
        places: HashMap::new(),
        entries: Vec::new(),
        known: HashMap::new(),
        others: Vec::new(),
        damaged: 0,
        states: Vec::new(),
    };
    let read = header(&mut stream).and_then(|()| log.records(&mut stream));
    let rows: usize = log.entries.iter().map(|entry| entry.time.values.len()).sum();
    let mut notes = Vec::new();
    match read {
        Err(problem) if rows == 0 => return Err(ImportError::damaged(path, problem)),
        Err(problem) => {
            let what = format!("what stands behind {rows} values is missing ({problem})");
            notes.push(Warning::Incomplete { what });
        }
        Ok(()) => {}
    }
    Ok(log.finish(notes))
}

/// The header of the file.
fn header(stream: &mut Stream) -> Result<(), Problem> {
    let mut head = Fields(stream.exactly(12)?);
    let version = head.bytes(6).and_then(|_| head.u16()).unwrap_or(0);
    let extra = head.u32().unwrap_or(0);
    if version >> 8 != 1 {
        return Err(format!("its version is {}.{}, and version 1.0 is read", version >> 8, version & 0xff));
    }
    if u64::from(extra) > LONGEST_RECORD {
        return Err(format!("a header of {extra} bytes is announced"));
    }
    stream.exactly(extra as usize).map(drop)
}

impl Log<'_> {
    fn records(&mut self, stream: &mut Stream) -> Result<(), Problem> {
        loop {
            let from = stream.at;
            let Some(lengths) = stream.up_to(1)?.first().copied() else { return Ok(()) };
            let bytes = |shift: u8, mask: u8| usize::from(lengths >> shift & mask) + 1;
            let (of_id, of_size, of_time) = (bytes(0, 3), bytes(2, 3), bytes(4, 7));
            let mut head = Fields(stream.exactly(of_id + of_size + of_time)?);
            let numbers = head.whole(of_id).zip(head.whole(of_size)).zip(head.whole(of_time));
            let ((id, size), time_us) = numbers.ok_or("a record has no header")?;
            if size > LONGEST_RECORD {
                return Err(format!("a record of {size} bytes is announced at byte {from}"));
            }
            let payload = stream.exactly(size as usize)?;
            if id == 0 {
                self.control(payload).ok_or_else(|| format!("the record at byte {from} is damaged"))?;
            } else {
                self.value(id as u32, time_us as i64, payload);
            }
        }
    }

    /// A record that starts or ends an entry, or says more of it.
    fn control(&mut self, payload: &[u8]) -> Option<()> {
        let mut fields = Fields(payload);
        let what = fields.u8()?;
        let id = fields.u32()?;
        match what {
            0 => {
                let (name, kind, metadata) = (fields.text()?, fields.text()?, fields.text()?);
                self.start(id, name, &kind, &metadata);
            }
            1 => drop(self.places.remove(&id)),
            2 => {
                let unit = unit(&fields.text()?);
                if let (Some(Place::Entry(index)), Some(unit)) = (self.places.get(&id), unit) {
                    self.entries[*index].unit = Some(unit);
                }
            }
            _ => {}
        }
        Some(())
    }

    fn start(&mut self, id: u32, name: String, kind: &str, metadata: &str) {
        let (bare, is_array) = kind.strip_suffix("[]").map_or((kind, false), |bare| (bare, true));
        let number = match bare {
            "boolean" => Kind::Boolean,
            "int64" => Kind::Int64,
            "float" => Kind::Float,
            "double" => Kind::Double,
            _ => {
                let is_state = kind == "string" && name.starts_with(SYSID_STATE);
                if !is_state {
                    self.others.push(format!("{name} ({kind})"));
                }
                self.places.insert(id, if is_state { Place::State } else { Place::Other });
                return;
            }
        };
        let key = (name, kind.to_owned());
        let index = match self.known.get(&key) {
            Some(index) => *index,
            None => {
                let name = key.0.clone();
                let entry = Entry {
                    is_wanted: is_array || self.wanted.takes(&name, &name) || self.wanted.takes(&name, TIME),
                    time: Signal::new(TIME, Some("us".into()), Vec::new()),
                    columns: Vec::new(),
                    kind: number,
                    unit: unit(metadata),
                    is_array,
                    name,
                };
                self.entries.push(entry);
                self.known.insert(key, self.entries.len() - 1);
                self.entries.len() - 1
            }
        };
        self.places.insert(id, Place::Entry(index));
    }

    fn value(&mut self, id: u32, time_us: i64, payload: &[u8]) {
        match self.places.get(&id) {
            Some(Place::Entry(index)) => {
                let entry = &mut self.entries[*index];
                if entry.is_wanted && entry.time.values.len() < self.wanted.most_rows {
                    self.damaged += usize::from(entry.push(time_us, payload, self.wanted).is_none());
                }
            }
            Some(Place::State) if self.states.len() < 1 << 16 => {
                let state = String::from_utf8_lossy(payload).into_owned();
                if self.states.last().is_none_or(|(_, last)| *last != state) {
                    self.states.push((time_us as f64 * 1e-6, state));
                }
            }
            Some(_) => {}
            None => self.damaged += 1,
        }
    }

    fn finish(self, mut notes: Vec<Warning>) -> Source {
        notes.extend(left_aside("entries that hold no numbers are", &self.others));
        if self.damaged > 0 {
            let problem =
                format!("{} values are of no entry, or not of its type, and are left aside", self.damaged);
            notes.push(Warning::Note(problem));
        }
        for (index, (start_s, state)) in
            self.states.iter().enumerate().filter(|(_, (_, state))| state != "none")
        {
            let end =
                self.states.get(index + 1).map_or("the end".into(), |(end_s, _)| format!("{end_s:.3} s"));
            notes.push(Warning::Note(format!("SysId's test `{state}` lasted from {start_s:.3} s to {end}")));
        }
        let groups = self.entries.into_iter().filter(|entry| !entry.columns.is_empty()).map(Entry::group);
        let mut source =
            Source { groups: groups.collect(), notes, ..Source::default() }.with_joined_groups().tidy();
        source.groups.retain(|group| group.signals.len() > 1);
        source
    }
}

impl Entry {
    /// Puts a value into a new row; `None` where its bytes are none of this type.
    fn push(&mut self, time_us: i64, payload: &[u8], wanted: &Wanted) -> Option<()> {
        let size = match self.kind {
            Kind::Boolean => 1,
            Kind::Float => 4,
            Kind::Int64 | Kind::Double => 8,
        };
        let count = payload.len() / size;
        let is_whole = payload.len() == count * size && (self.is_array || count == 1);
        if !is_whole {
            return None;
        }
        let rows = self.time.values.len();
        self.time.push_integer(time_us);
        let mut fields = Fields(payload);
        for index in 0..count.min(LONGEST_ARRAY) {
            if index == self.columns.len() {
                let name = if self.is_array { format!("{}.{index}", self.name) } else { self.name.clone() };
                self.columns.push(Signal::new(name, None, Vec::new()));
            }
            let column = &mut self.columns[index];
            if self.is_array && !wanted.takes(&self.name, &column.name) && !wanted.takes(&self.name, TIME) {
                fields.bytes(size)?;
                continue;
            }
            column.values.resize(rows, f64::NAN);
            match self.kind {
                Kind::Boolean => column.values.push(f64::from(u8::from(fields.u8()? != 0))),
                Kind::Int64 => column.push_integer(fields.u64()? as i64),
                Kind::Float => column.values.push(fields.f32()?.into()),
                Kind::Double => column.values.push(fields.f64()?),
            }
        }
        Some(())
    }

    fn group(mut self) -> Group {
        let rows = self.time.values.len();
        self.columns.retain(|column| !column.values.is_empty());
        for column in &mut self.columns {
            column.values.resize(rows, f64::NAN);
            column.unit.clone_from(&self.unit);
        }
        self.columns.insert(0, self.time);
        Group { name: self.name, signals: self.columns, time: Some(0), is_by_arrival: true }
    }
}
