//! Decoders: from a log's messages to rows, from its other records to its contents.

use std::collections::BTreeMap;

use mcap::records::{Record, op};

use super::contents::{AttachmentInfo, LogContents};
use super::names::{EVENT_TOPIC, METADATA_NAME, SAMPLE_TOPIC, STATUS_TOPIC, SUMMARY_NAME};
use super::order::SampleOrder;
use super::sample::{Field, decode_event, decode_status, fields};
use super::schema::{self, DEVICE_TIME_NS, EXACT_TIME_S, SEQUENCE, double_fields};
use crate::Channel;
use crate::table::Table;
use crate::warning::Warning;

/// Most events kept; a recording with more is still read.
const EVENTS: usize = 10_000;

/// Most values decoded from a chunk, times included (256 MB): short messages of many channels unpack to far more than the chunk.
const MOST_VALUES: usize = 32 << 20;

/// Length of the header before a message's content: channel (2 bytes), sequence (4), log time (8), publish time (8).
const MESSAGE_HEAD: usize = 22;

/// A message's channel and content.
fn message(body: &[u8]) -> Option<(u16, &[u8])> {
    Some((u16::from_le_bytes(*body.first_chunk()?), body.get(MESSAGE_HEAD..)?))
}

/// Turns messages of one channel into rows.
#[derive(Debug)]
pub(crate) struct SampleDecoder {
    channel: u16,
    /// Number and table column of each field to decode, sorted by number.
    columns: Vec<(u32, usize)>,
    /// Row by row: time, then columns.
    rows: Vec<f64>,
    order: SampleOrder,
}

impl SampleDecoder {
    /// Decodes a message's body: `None` when it is damaged (no row is added), `Some(false)` when it is no sample.
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
        if start > MOST_VALUES {
            return None;
        }
        self.rows.resize(start + 1 + columns.len(), f64::NAN);
        let row = &mut self.rows[start..];
        // Fields are usually complete and in the order of their numbers.
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
        self.order.append(&SampleOrder::of(time_s, sequence));
        Some(())
    }

    /// An empty table with its columns.
    pub(crate) fn table(&self) -> Table {
        Table::with_columns(self.columns.len())
    }

    /// Moves the rows decoded since the last call into a table; returns their order.
    pub(crate) fn hand_over(&mut self, table: &mut Table) -> SampleOrder {
        let width = 1 + self.columns.len();
        for (index, column) in table.all().enumerate() {
            column.extend(self.rows.chunks_exact(width).map(|row| row[index]));
        }
        self.rows.clear();
        std::mem::take(&mut self.order)
    }

    /// Drops the rows decoded since the last [`SampleDecoder::hand_over`].
    pub(crate) fn discard(&mut self) {
        self.rows.clear();
        self.order = SampleOrder::default();
    }
}

/// The topic of a log's samples, and the fields of its channels in them.
#[derive(Debug, Clone, Default)]
pub(crate) struct LogLayout {
    channel: u16,
    /// Field number of each channel.
    numbers: Vec<u32>,
}

impl LogLayout {
    /// A decoder of some channels (by index), in the order of the table's columns.
    pub(crate) fn decoder(&self, columns: &[usize]) -> SampleDecoder {
        let mut columns: Vec<(u32, usize)> = columns.iter().map(|c| self.numbers[*c]).zip(0..).collect();
        columns.sort_unstable();
        SampleDecoder { channel: self.channel, columns, rows: Vec::new(), order: SampleOrder::default() }
    }

    /// A decoder of all channels.
    pub(crate) fn decoder_of_all(&self) -> SampleDecoder {
        self.decoder(&(0..self.numbers.len()).collect::<Vec<_>>())
    }
}

/// Decodes all records but samples.
#[derive(Default)]
pub(crate) struct Decoder {
    schemas: BTreeMap<u16, (String, Vec<u8>)>,
    pub(crate) topics: Vec<String>,
    pub(crate) channels: Vec<Channel>,
    /// `None` until the samples' topic is found.
    pub(crate) layout: Option<LogLayout>,
    status_channel: Option<u16>,
    event_channel: Option<u16>,
    pub(crate) contents: LogContents,
    pub(crate) warnings: Vec<Warning>,
    /// Samples written and lost, by the log's own summary; `None` before it.
    pub(crate) counts: Option<[u64; 2]>,
}

impl Decoder {
    /// Decodes one record; `None` when it is damaged.
    pub(crate) fn take(&mut self, opcode: u8, body: &[u8]) -> Option<()> {
        if opcode == op::MESSAGE {
            return self.message(body);
        }
        match super::parse::record(opcode, body)? {
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
                if prefix == SUMMARY_NAME {
                    let number = |name| metadata.metadata.get(name)?.parse().ok();
                    self.counts = number("samples_written").zip(number("samples_lost")).map(<[u64; 2]>::from);
                } else {
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

    /// Field numbers of the channels. Names that are no identifiers of the schema are taken from the topic's metadata.
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
