//! From a log's records to rows and contents.

use std::collections::BTreeMap;

use mcap::records::{Record, op};

use super::sample::{Event, Field, Status, decode_event, decode_status, fields};
use super::schema::{DEVICE_TIME_NS, EXACT_TIME_S, SEQUENCE, double_fields};
use super::{EVENT_TOPIC, METADATA_NAME, SAMPLE_TOPIC, STATUS_TOPIC, SUMMARY_NAME, schema};
use crate::Channel;
use crate::dataset::Warning;
use crate::table::Table;

/// Events kept; a recording with more is still read.
const EVENTS: usize = 10_000;

/// Before a message's content: channel (2 bytes), sequence (4), log time (8), publish time (8).
const MESSAGE_HEAD: usize = 22;

/// What a log holds besides samples.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct LogContents {
    /// The program that wrote it.
    pub library: String,
    /// Time of the day at device time 0, ns since 1970 (UTC); `None` when the log does not say.
    pub start_unix_ns: Option<u64>,
    /// Duration meant when the recording was started, s.
    pub planned_duration_s: Option<f64>,
    /// Board, firmware, host versions, operator's notes, by name.
    pub metadata: BTreeMap<String, String>,
    /// Name, media type and length of each attachment; [`read_attachments`](crate::read_attachments) reads them.
    pub attachments: Vec<AttachmentInfo>,
    /// Events in order (the first ten thousand).
    pub events: Vec<Event>,
    /// The last status, if there was one.
    pub last_status: Option<Status>,
}

/// An attachment's name and size.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct AttachmentInfo {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its length, bytes.
    pub bytes: u64,
}

/// A message's channel and content.
fn message(body: &[u8]) -> Option<(u16, &[u8])> {
    Some((u16::from_le_bytes(*body.first_chunk()?), body.get(MESSAGE_HEAD..)?))
}

/// Whether samples follow each other as they should, in time and in number.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sequel {
    first: Option<Moment>,
    last: Option<Moment>,
    back_s: Option<(f64, f64)>,
    pub(crate) lost: u64,
}

/// Time and number of a sample.
#[derive(Debug, Clone, Copy)]
struct Moment {
    time_s: f64,
    sequence: Option<u64>,
}

impl Sequel {
    fn of(moment: Moment) -> Self {
        Self { first: Some(moment), last: Some(moment), ..Self::default() }
    }

    /// Appends what came after.
    pub(crate) fn append(&mut self, next: &Self) {
        if let (Some(last), Some(first)) = (self.last, next.first) {
            if first.time_s <= last.time_s {
                self.back_s.get_or_insert((last.time_s, first.time_s));
            }
            if let (Some(before), Some(after)) = (last.sequence, first.sequence) {
                let between = after.saturating_sub(before.wrapping_add(1));
                self.lost = self.lost.saturating_add(between);
            }
        }
        self.back_s = self.back_s.or(next.back_s);
        self.lost = self.lost.saturating_add(next.lost);
        self.first = self.first.or(next.first);
        self.last = next.last.or(self.last);
    }

    pub(crate) fn last_s(&self) -> Option<f64> {
        self.last.map(|moment| moment.time_s)
    }

    pub(crate) fn check_order(&self) -> Result<(), String> {
        match self.back_s {
            None => Ok(()),
            Some((last_s, time_s)) => Err(format!(
                "in this chunk time goes from {last_s} s to {time_s} s; it must increase from sample to sample: \
                 the clock was set back while recording, so record again"
            )),
        }
    }
}

/// Turns messages of one channel into rows.
#[derive(Debug)]
pub(crate) struct SampleDecoder {
    channel: u16,
    /// Numbers of the fields wanted with their columns in the table, by number.
    columns: Vec<(u32, usize)>,
    /// Row by row: time, then columns.
    rows: Vec<f64>,
    sequel: Sequel,
}

impl SampleDecoder {
    /// Takes a message's body; `None` when it is damaged, `Some(false)` when it is no sample. A damaged one leaves no trace.
    pub(crate) fn message(&mut self, body: &[u8]) -> Option<bool> {
        let (channel, content) = message(body)?;
        if channel != self.channel {
            return Some(false);
        }
        self.sample(content)?;
        Some(true)
    }

    fn sample(&mut self, content: &[u8]) -> Option<()> {
        let (mut device_time_ns, mut exact_s, mut sequence) = (0_i64, None, None);
        let columns = &self.columns;
        let start = self.rows.len();
        self.rows.resize(start + 1 + columns.len(), f64::NAN);
        let row = &mut self.rows[start..];
        // Fields come in the order of their numbers, mostly all of them.
        let mut next = 0;
        let whole = fields(content, |number, field| match field {
            Field::Varint(value) if number == DEVICE_TIME_NS => device_time_ns = value as i64,
            Field::Varint(value) if number == SEQUENCE => sequence = Some(value),
            Field::Double(value) if number == EXACT_TIME_S => exact_s = Some(value),
            Field::Double(value) => {
                let found = match columns.get(next) {
                    Some(column) if column.0 == number => Some(next),
                    _ => columns.binary_search_by_key(&number, |column| column.0).ok(),
                };
                if let Some(found) = found {
                    next = found + 1;
                    if value.is_finite() {
                        row[1 + columns[found].1] = value;
                    }
                }
            }
            _ => {}
        });
        if whole.is_none() {
            self.rows.truncate(start);
            return None;
        }
        let time_s = exact_s.unwrap_or(device_time_ns as f64 / 1e9);
        row[0] = time_s;
        self.sequel.append(&Sequel::of(Moment { time_s, sequence }));
        Some(())
    }

    /// A table of no rows for what it decodes.
    pub(crate) fn table(&self) -> Table {
        Table::with_columns(self.columns.len())
    }

    /// Moves the rows decoded since the last call into a table, and says how they follow each other.
    pub(crate) fn hand_over(&mut self, table: &mut Table) -> Sequel {
        let width = 1 + self.columns.len();
        for (index, column) in table.all().enumerate() {
            column.extend(self.rows.chunks_exact(width).map(|row| row[index]));
        }
        self.rows.clear();
        std::mem::take(&mut self.sequel)
    }

    /// Forgets the rows decoded since the last [`SampleDecoder::hand_over`].
    pub(crate) fn discard(&mut self) {
        self.rows.clear();
        self.sequel = Sequel::default();
    }
}

/// Which messages of a log are samples, and where its channels stand in them.
#[derive(Debug, Clone, Default)]
pub(crate) struct LogLayout {
    channel: u16,
    /// The field's number of each channel.
    numbers: Vec<u32>,
}

impl LogLayout {
    /// `columns`: the channels wanted, in that order.
    pub(crate) fn decoder(&self, columns: &[usize]) -> SampleDecoder {
        let mut columns: Vec<(u32, usize)> = columns.iter().map(|c| self.numbers[*c]).zip(0..).collect();
        columns.sort_unstable();
        SampleDecoder { channel: self.channel, columns, rows: Vec::new(), sequel: Sequel::default() }
    }

    /// Takes all channels.
    pub(crate) fn decoder_of_all(&self) -> SampleDecoder {
        self.decoder(&(0..self.numbers.len()).collect::<Vec<_>>())
    }
}

/// Turns all records but samples into contents.
#[derive(Default)]
pub(crate) struct Decoder {
    schemas: BTreeMap<u16, (String, Vec<u8>)>,
    pub(crate) topics: Vec<String>,
    pub(crate) channels: Vec<Channel>,
    /// Known once the samples' channel is.
    pub(crate) layout: Option<LogLayout>,
    status_channel: Option<u16>,
    event_channel: Option<u16>,
    pub(crate) contents: LogContents,
    pub(crate) warnings: Vec<Warning>,
}

impl Decoder {
    /// Takes one record; `None` when it is damaged.
    pub(crate) fn take(&mut self, opcode: u8, body: &[u8]) -> Option<()> {
        if opcode == op::MESSAGE {
            return self.message(body);
        }
        match mcap::parse_record(opcode, body).ok()? {
            Record::Header(header) => self.contents.library = header.library,
            Record::Schema { header, data } => {
                self.schemas.insert(header.id, (header.name, data.into_owned()));
            }
            Record::Channel(channel) => self.topic(channel),
            Record::Metadata(metadata) if metadata.name == METADATA_NAME => {
                let number = |name: &str| metadata.metadata.get(name);
                self.contents.start_unix_ns = number("start_unix_ns").and_then(|text| text.parse().ok());
                self.contents.planned_duration_s =
                    number("planned_duration_s").and_then(|text| text.parse().ok());
                self.contents.metadata.extend(metadata.metadata);
            }
            Record::Metadata(metadata) => {
                let prefix = metadata.name;
                if prefix != SUMMARY_NAME {
                    let entries = metadata.metadata.into_iter();
                    self.contents
                        .metadata
                        .extend(entries.map(|(name, text)| (format!("{prefix}.{name}"), text)));
                }
            }
            Record::Attachment { header, data, .. } => {
                self.contents.attachments.push(AttachmentInfo {
                    name: header.name,
                    media_type: header.media_type,
                    bytes: data.len() as u64,
                });
            }
            _ => {}
        }
        Some(())
    }

    fn message(&mut self, body: &[u8]) -> Option<()> {
        let (channel, content) = message(body)?;
        if Some(channel) == self.status_channel {
            self.contents.last_status = Some(decode_status(content)?);
        } else if Some(channel) == self.event_channel && self.contents.events.len() < EVENTS {
            self.contents.events.push(decode_event(content)?);
        }
        Some(())
    }

    fn topic(&mut self, channel: mcap::records::Channel) {
        if !self.topics.contains(&channel.topic) {
            self.topics.push(channel.topic.clone());
        }
        let Some((name, data)) = self.schemas.get(&channel.schema_id) else {
            return;
        };
        match channel.topic.as_str() {
            STATUS_TOPIC => self.status_channel = Some(channel.id),
            EVENT_TOPIC => self.event_channel = Some(channel.id),
            SAMPLE_TOPIC if name == schema::SAMPLE && self.layout.is_none() => {
                let Some(fields) = double_fields(data, name) else {
                    return;
                };
                let columns = channel.metadata.get("columns");
                let numbers = self.columns_of(fields, columns.map(String::as_str));
                self.layout = Some(LogLayout { channel: channel.id, numbers });
            }
            _ => {}
        }
    }

    /// Finds the channels among the message's fields. Names that were no identifiers stand in the topic's metadata.
    fn columns_of(&mut self, fields: Vec<(u32, String)>, names: Option<&str>) -> Vec<u32> {
        let names: Vec<String> = names.and_then(|names| serde_json::from_str(names).ok()).unwrap_or_default();
        let mut numbers = Vec::new();
        for (number, field) in fields {
            let written =
                number.checked_sub(schema::FIRST_CHANNEL).and_then(|index| names.get(index as usize));
            let column = written.cloned().unwrap_or(field);
            match Channel::from_column_name(&column) {
                _ if number == EXACT_TIME_S => {}
                Some(channel) => {
                    numbers.push(number);
                    self.channels.push(channel);
                }
                None => self.warnings.push(Warning::ColumnWithoutUnit { column }),
            }
        }
        numbers
    }
}
