//! TDMS of National Instruments, read by its published description (NI, "TDMS File Format Internal Structure").
//!
//! The two libraries that read it in Rust were tried: one leaves out all but the first chunk of a segment and does not know interleaved
//! data, without a word; the other is not maintained and panics on damaged files.

mod fields;
mod meta;
mod raw;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use socam_recording::Warning;

use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};
use fields::Property;
use meta::{LeadIn, Object, path_parts};
use raw::{Layout, Storage};

/// A channel while the segments are read.
#[derive(Debug, Default)]
pub(super) struct Channel {
    properties: BTreeMap<String, Property>,
    storage: Option<Storage>,
    values: Vec<f64>,
}

/// Why a segment cannot be read.
type Problem = String;

pub(crate) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
    let length = file.metadata().map_err(|error| ImportError::io(path, error))?.len();
    let mut reader = Reader {
        file: BufReader::new(file),
        length,
        wanted,
        names: Vec::new(),
        channels: BTreeMap::new(),
        layout: Layout::default(),
        notes: Vec::new(),
    };
    let mut at = 0;
    while at < length {
        match reader.segment(at) {
            Ok(next) => at = next,
            // The part before a damaged or cut segment is kept.
            Err(problem) if at > 0 => {
                reader.notes.push(Warning::Incomplete {
                    what: format!("samples from byte {at} on are missing ({problem})"),
                });
                break;
            }
            Err(problem) => {
                return Err(ImportError::damaged(path, problem));
            }
        }
    }
    Ok(reader.finish())
}

struct Reader<'w> {
    file: BufReader<File>,
    length: u64,
    wanted: &'w Wanted,
    /// Paths of channels in the order of their first appearance.
    names: Vec<String>,
    channels: BTreeMap<String, Channel>,
    layout: Layout,
    notes: Vec<Warning>,
}

impl Reader<'_> {
    /// Reads the segment at a byte; returns where the next one begins.
    fn segment(&mut self, at: u64) -> Result<u64, Problem> {
        let head = self.bytes(at, 28)?;
        let lead = LeadIn::parse(&head)?;
        let raw_at = (at + 28).checked_add(lead.raw_offset).filter(|raw_at| *raw_at <= self.length);
        let raw_at = raw_at.ok_or("its description runs beyond the file's end")?;
        // The writer fills in the length when the segment is complete.
        let next =
            (at + 28).checked_add(lead.next_offset).filter(|next| *next <= self.length && *next >= raw_at);
        if next.is_none() {
            self.notes.push(Warning::Incomplete { what: "its last segment is not complete".into() });
        }
        let next = next.unwrap_or(self.length);
        if lead.has_description() {
            let bytes = self.bytes(at + 28, lead.raw_offset)?;
            let objects = meta::objects(&bytes, lead.is_big_endian())?;
            self.describe(objects, lead.is_new_list())?;
        }
        if lead.has_data() {
            if lead.is_daqmx() {
                return Err(
                    "it holds unscaled DAQmx data; save it as scaled values, or as .csv, with NI's software"
                        .into(),
                );
            }
            self.data(raw_at, next, &lead)?;
        }
        Ok(next)
    }

    fn describe(&mut self, objects: Vec<Object>, is_new_list: bool) -> Result<(), Problem> {
        if is_new_list {
            self.layout.clear();
        }
        for object in objects {
            if !self.channels.contains_key(&object.path) {
                self.names.push(object.path.clone());
            }
            let channel = self.channels.entry(object.path.clone()).or_default();
            channel.properties.extend(object.properties);
            match object.storage {
                meta::Index::None => self.layout.remove(&object.path),
                meta::Index::Same => {
                    let storage =
                        channel.storage.ok_or("a channel refers to an index that was never given")?;
                    self.layout.set(&object.path, storage);
                }
                meta::Index::New(storage) => {
                    channel.storage = Some(storage);
                    self.layout.set(&object.path, storage);
                }
            }
        }
        Ok(())
    }

    fn data(&mut self, from: u64, to: u64, lead: &LeadIn) -> Result<(), Problem> {
        let chunk = self.layout.chunk_bytes()?;
        if chunk == 0 {
            return Ok(());
        }
        let mut at = from;
        while at < to {
            let length = chunk.min(to - at);
            let bytes = self.bytes(at, length)?;
            self.layout.decode(&bytes, lead.is_interleaved(), lead.is_big_endian(), |path, values| {
                let parts = path_parts(path);
                let is_wanted =
                    parts.as_ref().is_some_and(|(group, channel)| self.wanted.takes(group, channel));
                if let Some(channel) = self.channels.get_mut(path).filter(|_| is_wanted) {
                    let room = self.wanted.most_rows.saturating_sub(channel.values.len());
                    channel.values.extend(values.iter().take(room));
                }
            });
            at += length;
        }
        Ok(())
    }

    fn bytes(&mut self, at: u64, length: u64) -> Result<Vec<u8>, Problem> {
        if at.checked_add(length).is_none_or(|end| end > self.length) {
            return Err(format!(
                "{length} bytes are needed where {} are left",
                self.length.saturating_sub(at)
            ));
        }
        let mut bytes = vec![0; usize::try_from(length).map_err(|error| error.to_string())?];
        let read = self.file.seek(SeekFrom::Start(at)).and_then(|_| self.file.read_exact(&mut bytes));
        read.map_err(|error| error.to_string())?;
        Ok(bytes)
    }

    /// Channels of a group with the same length and waveform times share a clock.
    fn finish(mut self) -> Source {
        let mut groups: Vec<(String, usize, Option<Signal>, Vec<Signal>)> = Vec::new();
        for path in &self.names {
            let Some((group, name)) = path_parts(path) else { continue };
            let Some(channel) = self.channels.remove(path) else { continue };
            if channel.storage.is_some_and(|storage| !storage.is_number()) {
                self.notes
                    .push(Warning::Note(format!("channel `{group}/{name}` is no number and is left aside")));
                continue;
            }
            if channel.values.is_empty() {
                continue;
            }
            let clock = channel.waveform_times();
            let unit = channel.text("unit_string").or_else(|| channel.text("NI_UnitDescription"));
            let is_stamp = channel.storage.is_some_and(|storage| storage.is_time());
            let signal = if is_stamp {
                Signal::new(name, Some("s".into()), channel.values)
            } else {
                Signal::new(name, unit, channel.values)
            };
            let length = signal.values.len();
            match groups
                .iter_mut()
                .find(|(other, rows, time, _)| *other == group && *rows == length && *time == clock)
            {
                Some((.., signals)) => signals.push(signal),
                None => groups.push((group, length, clock, vec![signal])),
            }
        }
        let group = |(name, _, clock, mut signals): (String, usize, Option<Signal>, Vec<Signal>)| {
            let time = clock.is_some().then_some(0);
            signals.splice(0..0, clock);
            Group { name, signals, time, is_by_arrival: false }
        };
        Source { groups: groups.into_iter().map(group).collect(), notes: self.notes, ..Source::default() }
            .tidy()
    }
}

impl Channel {
    fn text(&self, name: &str) -> Option<String> {
        match self.properties.get(name)? {
            Property::Text(text) => Some(text.clone()),
            _ => None,
        }
    }

    fn number(&self, name: &str) -> Option<f64> {
        match self.properties.get(name)? {
            Property::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// Times of a waveform, which has a step instead of a time for each sample.
    fn waveform_times(&self) -> Option<Signal> {
        let step_s = self.number("wf_increment").filter(|step| step.is_finite() && *step > 0.0)?;
        let offset_s = self.number("wf_start_offset").unwrap_or(0.0);
        let start_ns = match self.properties.get("wf_start_time") {
            Some(Property::Time(nanoseconds)) => *nanoseconds,
            _ => 0,
        };
        let times = (0..self.values.len()).map(|row| (offset_s + step_s * row as f64) * 1e9).collect();
        Some(Signal { origin: start_ns, ..Signal::new("waveform time", Some("ns".into()), times) })
    }
}
