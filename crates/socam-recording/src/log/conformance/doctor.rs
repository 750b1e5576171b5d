//! Rules of the MCAP specification for finished logs, as `mcap doctor` verifies them: the summary that a log should have is computed
//! from its data section and compared with the one that it has.

use std::collections::BTreeMap;

use mcap::records::{
    AttachmentIndex, ChunkHeader, ChunkIndex, Footer, MessageIndex, MessageIndexEntry, MetadataIndex, Record,
    Statistics, SummaryOffset, op,
};

use super::crc32;
use crate::log::landmark::RECORD_HEAD;
use crate::log::parse;
use crate::log::records::ChunkOpener;

/// A record and its place.
struct Placed<'a> {
    opcode: u8,
    start: usize,
    end: usize,
    body: &'a [u8],
}

/// Contents of a data section, from which the expected summary follows.
#[derive(Default)]
struct Expected {
    problems: Vec<String>,
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, String>,
    statistics: Statistics,
    chunks: Vec<ChunkIndex>,
    attachments: Vec<AttachmentIndex>,
    metadata: Vec<MetadataIndex>,
    /// Message indexes that should follow the last chunk, by channel.
    indexes: BTreeMap<u16, Vec<MessageIndexEntry>>,
    latest: u64,
}

/// Problems of a finished log; none in one that keeps the rules.
pub(in crate::log) fn examine(bytes: &[u8]) -> Vec<String> {
    match records(bytes) {
        Ok(records) => examine_records(bytes, &records),
        Err(problem) => vec![problem],
    }
}

/// All records between both magics.
fn records(bytes: &[u8]) -> Result<Vec<Placed<'_>>, String> {
    let inside = bytes.strip_prefix(mcap::MAGIC).and_then(|rest| rest.strip_suffix(mcap::MAGIC));
    let end = mcap::MAGIC.len() + inside.ok_or("no magic at both ends")?.len();
    let (mut all, mut start) = (Vec::new(), mcap::MAGIC.len());
    while start < end {
        let head = bytes[start..end].first_chunk::<{ RECORD_HEAD as usize }>();
        let [opcode, length @ ..] = head.ok_or(format!("no record at {start}"))?;
        let body_start = start + RECORD_HEAD as usize;
        let body_end =
            usize::try_from(u64::from_le_bytes(*length)).ok().and_then(|n| body_start.checked_add(n));
        let stop = body_end.filter(|stop| *stop <= end).ok_or(format!("a record at {start} is too long"))?;
        all.push(Placed { opcode: *opcode, start, end: stop, body: &bytes[body_start..stop] });
        start = stop;
    }
    Ok(all)
}

fn examine_records(bytes: &[u8], records: &[Placed<'_>]) -> Vec<String> {
    let Some(data_end) = records.iter().position(|record| record.opcode == op::DATA_END) else {
        return vec!["no end of data".into()];
    };
    let mut found = Expected::default();
    for (number, record) in records[..data_end].iter().enumerate() {
        if (number == 0) != (record.opcode == op::HEADER) {
            found.problem(format!("record {number} is of kind {}", record.opcode));
        }
        found.data_record(record);
    }
    found.expect_no_index();
    let crc = u32::from_le_bytes(*records[data_end].body.first_chunk().unwrap_or(&[0; 4]));
    if crc != crc32(&bytes[..records[data_end].start]) {
        found.problem("the checksum of the data is wrong");
    }
    found.summary(bytes, &records[data_end..]);
    found.problems
}

impl Expected {
    fn problem(&mut self, text: impl Into<String>) {
        self.problems.push(text.into());
    }

    fn data_record(&mut self, record: &Placed<'_>) {
        if record.opcode != op::MESSAGE_INDEX {
            self.expect_no_index();
        }
        let place = (record.start as u64, (record.end - record.start) as u64);
        match parse::record(record.opcode, record.body) {
            Some(Record::Header(header)) if !header.library.is_empty() => {}
            Some(Record::Chunk { header, .. }) => self.chunk(place, header, record.body),
            Some(Record::MessageIndex(index)) => self.message_index(&index, place),
            Some(Record::Attachment { header, data, crc }) => {
                if crc == 0 {
                    self.problem("an attachment without a checksum");
                }
                self.statistics.attachment_count += 1;
                self.attachments.push(AttachmentIndex {
                    offset: place.0,
                    length: place.1,
                    log_time: header.log_time,
                    create_time: header.create_time,
                    data_size: data.len() as u64,
                    name: header.name,
                    media_type: header.media_type,
                });
            }
            Some(Record::Metadata(metadata)) => {
                self.statistics.metadata_count += 1;
                self.metadata.push(MetadataIndex { offset: place.0, length: place.1, name: metadata.name });
            }
            _ => self.problem(format!("a record of kind {} at {}", record.opcode, record.start)),
        }
    }

    fn chunk(&mut self, (start, length): (u64, u64), header: ChunkHeader, body: &[u8]) {
        let (mut offset, mut times) = (0, Vec::new());
        let whole = ChunkOpener::new().open(body, |opcode, body| {
            times.extend(self.chunk_record(opcode, body, offset));
            offset += RECORD_HEAD + body.len() as u64;
            Some(())
        });
        let range = [times.iter().min(), times.iter().max()].map(|time| time.copied().unwrap_or(0));
        let is_sound = whole.is_some()
            && header.uncompressed_crc != 0
            && offset == header.uncompressed_size
            && range == [header.message_start_time, header.message_end_time];
        if !is_sound {
            self.problem(format!("the chunk at {start} does not fit its head"));
        }
        let statistics = &mut self.statistics;
        if statistics.message_count == times.len() as u64 {
            statistics.message_start_time = range[0];
        }
        statistics.message_end_time = statistics.message_end_time.max(range[1]);
        statistics.chunk_count += 1;
        self.chunks.push(ChunkIndex {
            message_start_time: range[0],
            message_end_time: range[1],
            chunk_start_offset: start,
            chunk_length: length,
            message_index_offsets: BTreeMap::new(),
            message_index_length: 0,
            compression: header.compression,
            compressed_size: header.compressed_size,
            uncompressed_size: header.uncompressed_size,
        });
    }

    /// A record within a chunk; returns the time of a message.
    fn chunk_record(&mut self, opcode: u8, body: &[u8], offset: u64) -> Option<u64> {
        let again = |old: Option<String>, new: &String| old.is_some_and(|old| old != *new);
        match parse::record(opcode, body) {
            Some(record @ Record::Schema { .. }) => {
                let text = format!("{record:?}");
                let Record::Schema { header, .. } = record else { return None };
                if header.id == 0 || header.encoding.is_empty() {
                    self.problem("a schema without number or encoding");
                }
                if again(self.schemas.insert(header.id, text.clone()), &text) {
                    self.problem("two schemas of one number");
                }
            }
            Some(record @ Record::Channel(_)) => {
                let text = format!("{record:?}");
                let Record::Channel(channel) = record else { return None };
                if !self.schemas.contains_key(&channel.schema_id) {
                    self.problem("a channel of an unknown schema");
                }
                if again(self.channels.insert(channel.id, text.clone()), &text) {
                    self.problem("two channels of one number");
                }
            }
            Some(Record::Message { header, .. }) => {
                if !self.channels.contains_key(&header.channel_id) {
                    self.problem("a message of an unknown channel");
                }
                if header.log_time < self.latest {
                    self.problem(format!("log times decrease to {}", header.log_time));
                }
                self.latest = header.log_time;
                self.statistics.message_count += 1;
                *self.statistics.channel_message_counts.entry(header.channel_id).or_default() += 1;
                let entry = MessageIndexEntry { log_time: header.log_time, offset };
                self.indexes.entry(header.channel_id).or_default().push(entry);
                return Some(header.log_time);
            }
            _ => self.problem(format!("a record of kind {opcode} in a chunk")),
        }
        None
    }

    fn message_index(&mut self, index: &MessageIndex, (start, length): (u64, u64)) {
        if self.indexes.remove(&index.channel_id).as_ref() != Some(&index.records) {
            self.problem(format!("the message index at {start} does not fit its chunk"));
        }
        if let Some(chunk) = self.chunks.last_mut() {
            chunk.message_index_offsets.insert(index.channel_id, start);
            chunk.message_index_length += length;
        }
    }

    fn expect_no_index(&mut self) {
        let missing: Vec<u16> = std::mem::take(&mut self.indexes).into_keys().collect();
        if !missing.is_empty() {
            self.problem(format!("no message index of channels {missing:?}"));
        }
    }

    /// Compares the summary, from the end of the data on, with what it should be.
    fn summary(&mut self, bytes: &[u8], records: &[Placed<'_>]) {
        let (Some(data_end), Some(footer)) = (records.first(), records.last()) else { return };
        self.statistics.schema_count = self.schemas.len() as u16;
        self.statistics.channel_count = self.channels.len() as u32;
        let mut groups: Vec<SummaryOffset> = Vec::new();
        let mut found: BTreeMap<u8, Vec<String>> = BTreeMap::new();
        let mut offsets_start = 0;
        for record in &records[1..records.len() - 1] {
            let decoded = parse::record(record.opcode, record.body);
            found.entry(record.opcode).or_default().push(format!("{decoded:?}"));
            match groups.last_mut() {
                _ if record.opcode == op::SUMMARY_OFFSET && offsets_start > 0 => {}
                _ if record.opcode == op::SUMMARY_OFFSET => offsets_start = record.start as u64,
                Some(group) if group.group_opcode == record.opcode => {
                    group.group_length = record.end as u64 - group.group_start;
                }
                _ => groups.push(SummaryOffset {
                    group_opcode: record.opcode,
                    group_start: record.start as u64,
                    group_length: (record.end - record.start) as u64,
                }),
            }
        }
        let in_file: Vec<u8> = groups.iter().map(|group| group.group_opcode).collect();
        let expected = self.expected(groups);
        if found != expected {
            self.problem(format!("the summary (kinds {in_file:?}) is {found:?} and should be {expected:?}"));
        }
        // The checksum covers the footer's first two fields too.
        let crc = crc32(&bytes[data_end.end..footer.start + RECORD_HEAD as usize + 16]);
        let should_be = Footer {
            summary_start: data_end.end as u64,
            summary_offset_start: offsets_start,
            summary_crc: crc,
        };
        match parse::record(footer.opcode, footer.body) {
            Some(Record::Footer(footer)) if footer == should_be => {}
            other => self.problem(format!("the footer is {other:?} and should be {should_be:?}")),
        }
    }

    /// Records that the summary should contain, by their kind; `groups` are those of the file.
    fn expected(&self, groups: Vec<SummaryOffset>) -> BTreeMap<u8, Vec<String>> {
        fn texts<T: Clone>(all: &[T], record: fn(T) -> Record<'static>) -> Vec<String> {
            all.iter().map(|one| format!("{:?}", Some(record(one.clone())))).collect()
        }
        let some = |all: &BTreeMap<u16, String>| all.values().map(|text| format!("Some({text})")).collect();
        let all: [(u8, Vec<String>); 7] = [
            (op::SCHEMA, some(&self.schemas)),
            (op::CHANNEL, some(&self.channels)),
            (op::STATISTICS, texts(std::slice::from_ref(&self.statistics), Record::Statistics)),
            (op::CHUNK_INDEX, texts(&self.chunks, Record::ChunkIndex)),
            (op::ATTACHMENT_INDEX, texts(&self.attachments, Record::AttachmentIndex)),
            (op::METADATA_INDEX, texts(&self.metadata, Record::MetadataIndex)),
            (op::SUMMARY_OFFSET, texts(&groups, Record::SummaryOffset)),
        ];
        all.into_iter().filter(|(_, records)| !records.is_empty()).collect()
    }
}
