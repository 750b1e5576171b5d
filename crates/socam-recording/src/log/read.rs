//! Reads a log record by record: memory stays at one chunk, and a log cut off or damaged anywhere gives all that is whole.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::sample::{Event, Field, Status, decode_event, decode_status, fields};
use super::schema::{DEVICE_TIME_NS, EXACT_TIME_S, SEQUENCE, double_fields};
use super::writer::Attachment;
use super::{EVENT_TOPIC, METADATA_NAME, SAMPLE_TOPIC, STATUS_TOPIC, SUMMARY_NAME, schema};
use crate::Channel;
use crate::dataset::{Cut, EndOfRows, Table, Warning};
use crate::error::{RecordingError, Result};

/// Bytes asked from the system at a time.
const BUFFER_BYTES: usize = 1 << 18;

/// Largest record read into memory (chunks are 1 MiB; attachments are small files).
const RECORD_BYTES: u64 = 128 << 20;

/// Events kept; a recording with more is still read.
const EVENTS: usize = 10_000;

/// Opcode and length before every record.
const RECORD_HEAD: u64 = 9;

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
    /// Name, media type and length of each attachment; [`read_attachments`] reads them.
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

/// Attachments of a log, with their content, in the file's order.
///
/// # Errors
/// When the file cannot be read or is no MCAP log. Attachments after a cut are not there.
pub fn read_attachments(path: &Path) -> Result<Vec<Attachment>> {
    let mut records = Records::open(path)?;
    let mut attachments = Vec::new();
    while let Next::Record { opcode, body, .. } = records.next(|opcode| opcode == op::ATTACHMENT)? {
        if opcode == op::ATTACHMENT
            && let Ok(Record::Attachment { header, data, .. }) = mcap::parse_record(opcode, body)
        {
            attachments.push(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            });
        }
    }
    Ok(attachments)
}

/// Whole records of a file, one at a time, skipping those that are not wanted.
struct Records {
    path: PathBuf,
    file: BufReader<File>,
    length: u64,
    position: u64,
    body: Vec<u8>,
}

enum Next<'a> {
    Record {
        opcode: u8,
        byte: u64,
        body: &'a [u8],
    },
    /// The end as it should be.
    End,
    /// The file stops, or stops making sense, at this byte.
    Cut(u64),
}

impl Records {
    fn open(path: &Path) -> Result<Self> {
        let open = || -> io::Result<(BufReader<File>, u64, [u8; 8])> {
            let file = File::open(path)?;
            let length = file.metadata()?.len();
            let mut file = BufReader::with_capacity(BUFFER_BYTES, file);
            let mut magic = [0; 8];
            file.read_exact(&mut magic)?;
            Ok((file, length, magic))
        };
        let (file, length, magic) = open().map_err(|e| RecordingError::io(path, "read", e))?;
        if magic != *mcap::MAGIC {
            return Err(RecordingError::Byte {
                path: path.into(),
                byte: 0,
                problem: "expected the beginning of an MCAP log; this is another kind of file".into(),
            });
        }
        Ok(Self { path: path.into(), file, length, position: 8, body: Vec::new() })
    }

    /// The next record; its body is empty unless `wanted`.
    fn next(&mut self, wanted: impl Fn(u8) -> bool) -> Result<Next<'_>> {
        let byte = self.position;
        let left = self.length.saturating_sub(byte);
        if left < RECORD_HEAD {
            return Ok(Next::Cut(byte));
        }
        let mut head = [0; RECORD_HEAD as usize];
        self.read(|file| file.read_exact(&mut head))?;
        let opcode = head[0];
        let length =
            u64::from_le_bytes([head[1], head[2], head[3], head[4], head[5], head[6], head[7], head[8]]);
        if opcode == 0 || length > left - RECORD_HEAD {
            return Ok(Next::Cut(byte));
        }
        if opcode == op::FOOTER {
            let end = byte + RECORD_HEAD + length + mcap::MAGIC.len() as u64;
            return Ok(if end <= self.length { Next::End } else { Next::Cut(byte) });
        }
        self.body.clear();
        if wanted(opcode) {
            if length > RECORD_BYTES {
                return Err(RecordingError::Byte {
                    path: self.path.clone(),
                    byte,
                    problem: format!(
                        "a record of {length} bytes; expected at most {RECORD_BYTES}: rewrite the log with smaller chunks"
                    ),
                });
            }
            self.body.resize(length as usize, 0);
            let mut body = std::mem::take(&mut self.body);
            self.read(|file| file.read_exact(&mut body))?;
            self.body = body;
        } else {
            self.read(|file| file.seek_relative(length as i64))?;
        }
        self.position = byte + RECORD_HEAD + length;
        Ok(Next::Record { opcode, byte, body: &self.body })
    }

    fn read(&mut self, read: impl FnOnce(&mut BufReader<File>) -> io::Result<()>) -> Result<()> {
        read(&mut self.file).map_err(|e| RecordingError::io(&self.path, "read", e))
    }
}

/// Samples streaming from a log.
pub(crate) struct LogRows {
    records: Records,
    chunks: ChunkOpener,
    decoder: Decoder,
    wanted: Option<Vec<usize>>,
    ready: Table,
    given: usize,
    ended: bool,
    cut: Option<u64>,
    damaged: Vec<(u64, u64)>,
    samples_whole: bool,
}

impl LogRows {
    /// Reads up to the first samples. `wanted`: which of the log's channels to read; all when `None`.
    pub(crate) fn open(path: &Path, wanted: Option<&[usize]>) -> Result<Self> {
        let mut rows = Self {
            records: Records::open(path)?,
            chunks: ChunkOpener::new(),
            decoder: Decoder::default(),
            wanted: wanted.map(Into::into),
            ready: Table::default(),
            given: 0,
            ended: false,
            cut: None,
            damaged: Vec::new(),
            samples_whole: false,
        };
        while rows.ready.time_s.is_empty() && !rows.ended {
            rows.advance()?;
        }
        if rows.decoder.sample_channel.is_none() {
            return Err(rows.without_samples());
        }
        Ok(rows)
    }

    pub(crate) fn channels(&self) -> &[Channel] {
        &self.decoder.channels
    }

    /// Appends at most about `limit` rows; false once there are no more.
    pub(crate) fn read(&mut self, table: &mut Table, limit: usize) -> Result<bool> {
        while self.given == self.ready.time_s.len() {
            if self.ended {
                return Ok(false);
            }
            self.ready.clear();
            self.given = 0;
            self.advance()?;
        }
        let end = self.ready.time_s.len().min(self.given + limit);
        let range = self.given..end;
        self.given = end;
        table.time_s.extend_from_slice(&self.ready.time_s[range.clone()]);
        for (to, from) in table.columns.iter_mut().zip(&self.ready.columns) {
            to.extend_from_slice(&from[range.clone()]);
        }
        Ok(true)
    }

    /// Reads one record.
    fn advance(&mut self) -> Result<()> {
        let wanted = |opcode| {
            matches!(
                opcode,
                op::HEADER
                    | op::CHUNK
                    | op::SCHEMA
                    | op::CHANNEL
                    | op::MESSAGE
                    | op::METADATA
                    | op::ATTACHMENT
                    | op::DATA_END
            )
        };
        let (opcode, byte, body) = match self.records.next(wanted)? {
            Next::Record { opcode, byte, body } => (opcode, byte, body),
            Next::End => {
                self.ended = true;
                return Ok(());
            }
            Next::Cut(byte) => {
                self.ended = true;
                self.cut = Some(byte);
                return Ok(());
            }
        };
        if !wanted(opcode) {
            return Ok(());
        }
        if opcode == op::DATA_END {
            // What follows repeats what was read. Only its end tells whether the file is whole.
            return self.skip_summary();
        }
        let rows_before = self.ready.time_s.len();
        let decoder = &mut self.decoder;
        let columns = self.wanted.as_deref();
        let table = &mut self.ready;
        let whole = if opcode == op::CHUNK {
            self.chunks.open(body, |opcode, body| decoder.take(opcode, body, columns, table))
        } else {
            decoder.take(opcode, body, columns, table)
        };
        if whole.is_none() {
            self.ready.truncate(rows_before);
            self.damaged.push((byte, body.len() as u64 + RECORD_HEAD));
        }
        self.decoder.check_order().map_err(|problem| RecordingError::Byte {
            path: self.records.path.clone(),
            byte,
            problem,
        })
    }

    fn skip_summary(&mut self) -> Result<()> {
        self.samples_whole = true;
        loop {
            match self.records.next(|_| false)? {
                Next::Record { .. } => {}
                Next::End => break,
                Next::Cut(byte) => {
                    self.cut = Some(byte);
                    break;
                }
            }
        }
        self.ended = true;
        Ok(())
    }

    fn without_samples(&self) -> RecordingError {
        let path = self.records.path.clone();
        let topics = &self.decoder.topics;
        if let Some(byte) = self.cut
            && topics.is_empty()
        {
            return RecordingError::Byte {
                path,
                byte,
                problem: "the log is cut off here, before anything was recorded; record again".into(),
            };
        }
        RecordingError::ForeignMcap {
            path,
            topics: if topics.is_empty() { "none".into() } else { topics.join(", ") },
        }
    }

    pub(crate) fn finish(self) -> EndOfRows {
        let mut end = EndOfRows {
            warnings: self.decoder.warnings,
            lost_samples: self.decoder.lost,
            ..EndOfRows::default()
        };
        if self.decoder.lost > 0 {
            end.warnings.push(Warning::LostSamples { samples: self.decoder.lost });
        }
        for (byte, bytes) in self.damaged {
            end.warnings.push(Warning::Damaged { byte, bytes });
        }
        if let Some(byte) = self.cut {
            let cut = Cut {
                byte,
                unused_bytes: self.records.length - byte,
                missing: if self.samples_whole {
                    "only the index at its end, all samples are there".into()
                } else {
                    missing(&self.decoder.contents, self.decoder.previous_s)
                },
            };
            end.warnings.push(Warning::CutOff { missing: cut.missing.clone() });
            end.cut = Some(cut);
        }
        end.contents = Some(self.decoder.contents);
        end
    }
}

/// What a cut recording lacks, as far as can be known.
fn missing(contents: &LogContents, last_s: Option<f64>) -> String {
    let last_s = last_s.unwrap_or(0.0);
    let rest = match contents.planned_duration_s {
        Some(planned_s) if planned_s > last_s => {
            format!("the last {:.3} s of the planned {planned_s} s", planned_s - last_s)
        }
        _ => format!("all after {last_s} s (of a running recording, at most its last second)"),
    };
    format!("{rest}, and the index at its end")
}

/// Opens chunks: decompresses, verifies the checksum, and gives out the records inside.
struct ChunkOpener {
    reader: LinearReader,
}

impl ChunkOpener {
    fn new() -> Self {
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(RECORD_BYTES as usize);
        Self { reader: LinearReader::new_with_options(options) }
    }

    /// Calls `take` with each record of a chunk; `None` when the chunk or a record in it is damaged.
    fn open(&mut self, body: &[u8], mut take: impl FnMut(u8, &[u8]) -> Option<()>) -> Option<()> {
        let whole = self.feed(body, &mut take);
        if whole.is_none() {
            *self = Self::new();
        }
        whole
    }

    fn feed(&mut self, body: &[u8], take: &mut impl FnMut(u8, &[u8]) -> Option<()>) -> Option<()> {
        let mut head = [0; RECORD_HEAD as usize];
        head[0] = op::CHUNK;
        head[1..].copy_from_slice(&(body.len() as u64).to_le_bytes());
        let mut given: [&[u8]; 2] = [&head, body];
        while let Some(event) = self.reader.next_event() {
            match event.ok()? {
                LinearReadEvent::Record { opcode, data } => take(opcode, data)?,
                LinearReadEvent::ReadRequest(need) => {
                    let from = given.iter_mut().find(|bytes| !bytes.is_empty());
                    let Some(from) = from else {
                        return Some(());
                    };
                    let (now, later) = from.split_at(need.min(from.len()));
                    *from = later;
                    self.reader.insert(now.len()).copy_from_slice(now);
                    self.reader.notify_read(now.len());
                }
            }
        }
        Some(())
    }
}

/// Turns records into rows and contents.
#[derive(Default)]
struct Decoder {
    schemas: BTreeMap<u16, (String, Vec<u8>)>,
    topics: Vec<String>,
    channels: Vec<Channel>,
    /// The MCAP channel of samples, and its fields' numbers with their columns in the table, by number.
    sample_channel: Option<u16>,
    columns: Vec<(u32, usize)>,
    status_channel: Option<u16>,
    event_channel: Option<u16>,
    previous_s: Option<f64>,
    back: Option<(f64, f64)>,
    next_sequence: Option<u64>,
    lost: u64,
    contents: LogContents,
    warnings: Vec<Warning>,
}

impl Decoder {
    /// Takes one record; `None` when it is damaged.
    fn take(&mut self, opcode: u8, body: &[u8], wanted: Option<&[usize]>, table: &mut Table) -> Option<()> {
        if opcode == op::MESSAGE {
            return self.message(body, table);
        }
        match mcap::parse_record(opcode, body).ok()? {
            Record::Header(header) => self.contents.library = header.library,
            Record::Schema { header, data } => {
                self.schemas.insert(header.id, (header.name, data.into_owned()));
            }
            Record::Channel(channel) => self.topic(channel, wanted, table),
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

    fn topic(&mut self, channel: mcap::records::Channel, wanted: Option<&[usize]>, table: &mut Table) {
        if !self.topics.contains(&channel.topic) {
            self.topics.push(channel.topic.clone());
        }
        let Some((name, data)) = self.schemas.get(&channel.schema_id) else {
            return;
        };
        match channel.topic.as_str() {
            STATUS_TOPIC => self.status_channel = Some(channel.id),
            EVENT_TOPIC => self.event_channel = Some(channel.id),
            SAMPLE_TOPIC if name == schema::SAMPLE && self.sample_channel.is_none() => {
                let Some(fields) = double_fields(data, name) else {
                    return;
                };
                self.sample_channel = Some(channel.id);
                let columns = channel.metadata.get("columns");
                self.columns_of(fields, columns.map(String::as_str), wanted);
                *table = Table::with_columns(self.channels.len());
            }
            _ => {}
        }
    }

    /// Finds the channels among the message's fields. Names that were no identifiers stand in the topic's metadata.
    fn columns_of(&mut self, fields: Vec<(u32, String)>, names: Option<&str>, wanted: Option<&[usize]>) {
        let names: Vec<String> = names.and_then(|names| serde_json::from_str(names).ok()).unwrap_or_default();
        let mut all = Vec::new();
        for (number, field) in fields {
            let written =
                number.checked_sub(schema::FIRST_CHANNEL).and_then(|index| names.get(index as usize));
            let column = written.cloned().unwrap_or(field);
            match Channel::from_column_name(&column) {
                _ if number == EXACT_TIME_S => {}
                Some(channel) => all.push((number, channel)),
                None => self.warnings.push(Warning::ColumnWithoutUnit { column }),
            }
        }
        if let Some(wanted) = wanted {
            all = wanted.iter().filter_map(|&i| all.get(i).cloned()).collect();
        }
        for (index, (number, channel)) in all.into_iter().enumerate() {
            self.columns.push((number, index));
            self.channels.push(channel);
        }
        self.columns.sort_unstable();
    }

    fn message(&mut self, body: &[u8], table: &mut Table) -> Option<()> {
        // channel id (2 bytes), sequence (4), log time (8), publish time (8), content
        let (id, rest) = body.split_first_chunk()?;
        let id = Some(u16::from_le_bytes(*id));
        let content = rest.get(20..)?;
        if id == self.sample_channel {
            self.sample(content, table)?;
        } else if id == self.status_channel {
            self.contents.last_status = Some(decode_status(content)?);
        } else if id == self.event_channel && self.contents.events.len() < EVENTS {
            self.contents.events.push(decode_event(content)?);
        }
        Some(())
    }

    fn sample(&mut self, content: &[u8], table: &mut Table) -> Option<()> {
        let (mut device_time_ns, mut exact_s, mut sequence) = (0_i64, None, None);
        let columns = &self.columns;
        for column in &mut table.columns {
            column.push(f64::NAN);
        }
        let row = table.time_s.len();
        fields(content, |number, field| match (number, field) {
            (DEVICE_TIME_NS, Field::Varint(value)) => device_time_ns = value as i64,
            (SEQUENCE, Field::Varint(value)) => sequence = Some(value),
            (EXACT_TIME_S, Field::Double(value)) => exact_s = Some(value),
            (number, Field::Double(value)) => {
                if let Ok(found) = columns.binary_search_by_key(&number, |column| column.0)
                    && value.is_finite()
                {
                    table.columns[columns[found].1][row] = value;
                }
            }
            _ => {}
        })?;
        let time_s = exact_s.unwrap_or(device_time_ns as f64 / 1e9);
        table.time_s.push(time_s);
        if let Some(previous_s) = self.previous_s
            && time_s <= previous_s
        {
            self.back.get_or_insert((previous_s, time_s));
        }
        self.previous_s = Some(time_s);
        if let (Some(expected), Some(sequence)) = (self.next_sequence, sequence) {
            self.lost = self.lost.saturating_add(sequence.saturating_sub(expected));
        }
        self.next_sequence = sequence.map(|sequence| sequence.wrapping_add(1));
        Some(())
    }

    fn check_order(&self) -> Result<(), String> {
        match self.back {
            None => Ok(()),
            Some((previous_s, time_s)) => Err(format!(
                "in this chunk time goes from {previous_s} s to {time_s} s; it must increase from sample to sample: \
                 the clock was set back while recording, so record again"
            )),
        }
    }
}
