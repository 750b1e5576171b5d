//! Signals of frames, while a log is read.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use socam_recording::Warning;

use super::Frame;
use super::database::{Database, EXTENDED};
use crate::error::{ImportError, Result, few};
use crate::source::{Group, Signal, Source, Wanted};

/// Name of a group's clock.
const TIME: &str = "time";

/// What was found so far.
pub(super) struct Signals<'d> {
    database: &'d Database,
    wanted: &'d Wanted,
    /// Number of frames that the DBC describes.
    pub(super) frames: usize,
    /// Groups by bus and frame, one for each set of its signals that was seen.
    groups: BTreeMap<String, BTreeMap<u32, Vec<Option<Rows>>>>,
    /// Identifiers that the DBC does not describe, with their number of frames.
    unknown: HashMap<u32, usize>,
    short: usize,
}

/// Rows of a set.
struct Rows {
    time: Signal,
    /// Index of each signal that is read, and its values.
    columns: Vec<(usize, Vec<f64>)>,
}

impl<'d> Signals<'d> {
    pub(super) fn new(database: &'d Database, wanted: &'d Wanted) -> Self {
        Self { database, wanted, frames: 0, groups: BTreeMap::new(), unknown: HashMap::new(), short: 0 }
    }

    /// Takes a frame.
    pub(super) fn push(&mut self, frame: &Frame<'_>) {
        let Some(known) = self.database.frames.get(&frame.id) else {
            *self.unknown.entry(frame.id).or_default() += 1;
            return;
        };
        self.frames += 1;
        if !self.groups.contains_key(frame.bus) {
            self.groups.insert(frame.bus.to_owned(), BTreeMap::new());
        }
        let Some(bus) = self.groups.get_mut(frame.bus) else { return };
        let sets = bus.entry(frame.id).or_insert_with(|| known.sets.iter().map(|_| None).collect());
        for (set, rows) in known.sets.iter().zip(sets) {
            if !known.holds(set, frame.bytes) {
                continue;
            }
            let rows = rows.get_or_insert_with(|| {
                let taken =
                    set.signals.iter().filter(|index| self.wanted.may_take(&known.signals[**index].name));
                let columns = taken.map(|index| (*index, Vec::new())).collect();
                Rows { time: Signal::new(TIME, Some("ns".into()), Vec::new()), columns }
            });
            if rows.time.values.len() >= self.wanted.most_rows {
                continue;
            }
            rows.time.push_integer(frame.time_ns);
            for (index, column) in &mut rows.columns {
                let value = known.signals[*index].value(frame.bytes);
                self.short += usize::from(value.is_none());
                column.push(value.unwrap_or(f64::NAN));
            }
        }
    }

    pub(super) fn finish(self, path: &Path) -> Result<Source> {
        let Self { database, wanted, groups, unknown, .. } = self;
        if groups.is_empty() {
            let problem = if unknown.is_empty() {
                "holds no frame with data; record again".to_owned()
            } else {
                format!(
                    "holds no frame that `{}` describes, but {}; name the DBC of this bus",
                    database.path.display(),
                    identifiers(&unknown)
                )
            };
            return Err(ImportError::file(path, problem));
        }
        let mut notes = Vec::new();
        if !unknown.is_empty() {
            notes.push(Warning::Note(format!(
                "frames that the DBC does not describe are left aside: {}",
                identifiers(&unknown)
            )));
        }
        if self.short > 0 {
            notes.push(Warning::Note(format!(
                "{} values are missing, since their frames are shorter than the DBC says",
                self.short
            )));
        }
        let is_single = groups.len() == 1;
        let frames = groups.into_iter().flat_map(|(bus, frames)| {
            frames.into_iter().map(move |(id, sets)| (bus.clone(), &database.frames[&id], sets))
        });
        let mut found = Vec::new();
        for (bus, known, sets) in frames {
            if known.left_aside > 0 {
                let name = known.sets.first().map_or("", |set| &set.name);
                notes.push(Warning::Note(format!(
                    "{} signals of `{name}` have no place in a frame, or are too many, and are left aside",
                    known.left_aside
                )));
            }
            for (set, rows) in known.sets.iter().zip(sets) {
                let Some(rows) = rows else { continue };
                let named = |(index, values): (usize, Vec<f64>)| {
                    let signal = &known.signals[index];
                    Signal::new(signal.name.clone(), Some(signal.unit.clone()), values)
                };
                let signals = std::iter::once(rows.time).chain(rows.columns.into_iter().map(named)).collect();
                let name = if is_single { set.name.clone() } else { format!("{bus} {}", set.name) };
                found.push(Group { name, signals, time: Some(0), is_by_arrival: true });
            }
        }
        let mut source = Source { groups: found, notes, ..Source::default() }.tidy();
        source.keep(wanted);
        source.groups.retain(|group| group.signals.len() > 1);
        Ok(source)
    }
}

/// Identifiers in hexadecimal, the most frequent first.
fn identifiers(unknown: &HashMap<u32, usize>) -> String {
    const SHOWN: usize = 8;
    let mut all: Vec<(u32, usize)> = unknown.iter().map(|(id, count)| (*id, *count)).collect();
    all.sort_by_key(|(id, count)| (std::cmp::Reverse(*count), *id));
    few(&all, SHOWN, |(id, count)| format!("{:X} ({count} times)", id & !EXTENDED))
}
