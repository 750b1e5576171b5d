//! The files of the MCAP project's conformance suite (`tests/conformance` of github.com/foxglove/mcap), generated from its tables of
//! inputs and features, with the records that a reader must find in each.

use std::borrow::Cow;
use std::collections::BTreeMap;

use mcap::records::{
    AttachmentHeader, AttachmentIndex, Channel, ChunkHeader, ChunkIndex, DataEnd, Footer, Header,
    MessageHeader, MessageIndex, MessageIndexEntry, Metadata, MetadataIndex, Record, SchemaHeader,
    Statistics, SummaryOffset, op,
};

use super::bytes::record_bytes;
use super::crc32;
use crate::log::landmark::RECORD_HEAD;

/// Features in the order of the suite, which is that of a file's name after sorting.
const FEATURES: [&str; 10] = ["ax", "ch", "chx", "mdx", "mx", "pad", "rch", "rsh", "st", "sum"];

/// A file and what it holds.
pub(super) struct Variant {
    pub(super) name: String,
    pub(super) bytes: Vec<u8>,
    /// Records in the order of the file, those of chunks in place of their chunk; message indexes and footer left out.
    pub(super) records: Vec<String>,
}

/// All files of the suite.
pub(super) fn variants() -> Vec<Variant> {
    let mut all = Vec::new();
    for (name, records) in inputs() {
        for bits in 0..1 << FEATURES.len() {
            let chosen: Vec<&str> = FEATURES
                .iter()
                .enumerate()
                .filter(|(bit, _)| bits >> bit & 1 == 1)
                .map(|(_, name)| *name)
                .collect();
            if makes_sense(&chosen, &records) {
                let name = [&[name], &chosen[..]].concat().join("-");
                let mut file = File::new(chosen);
                file.write(&records);
                all.push(Variant { name, bytes: file.bytes, records: file.records });
            }
        }
    }
    all
}

/// Whether the records have what the features are about.
fn makes_sense(features: &[&str], records: &[Record<'_>]) -> bool {
    let has = |feature| features.contains(&feature);
    let holds = |opcode| records.iter().any(|record| record.opcode() == opcode);
    let needs = [
        ("ax", holds(op::ATTACHMENT)),
        ("mdx", holds(op::METADATA)),
        ("rsh", holds(op::SCHEMA)),
        ("rch", holds(op::CHANNEL)),
        ("ch", holds(op::CHANNEL)),
        ("chx", has("ch")),
        ("mx", has("ch")),
        ("sum", ["chx", "rsh", "rch", "mdx", "ax", "st"].into_iter().any(has)),
    ];
    needs.iter().all(|(feature, met)| *met || !has(feature))
}

fn inputs() -> [(&'static str, Vec<Record<'static>>); 6] {
    let data = || Cow::Borrowed(&[1, 2, 3][..]);
    let channel = |schema_id, encoding: &str, metadata| {
        let topic = "example".into();
        Record::Channel(Channel { id: 1, schema_id, topic, message_encoding: encoding.into(), metadata })
    };
    let foo = || BTreeMap::from([("foo".into(), "bar".into())]);
    let message = |sequence, publish_time, log_time| Record::Message {
        header: MessageHeader { channel_id: 1, sequence, log_time, publish_time },
        data: data(),
    };
    let described = || {
        let header = SchemaHeader { id: 1, name: "Example".into(), encoding: "c".into() };
        vec![Record::Schema { header, data: Cow::Borrowed(&[4, 5, 6]) }, channel(1, "a", foo())]
    };
    let attachment = |crc| Record::Attachment {
        header: AttachmentHeader {
            log_time: 2,
            create_time: 1,
            name: "myFile".into(),
            media_type: "application/octet-stream".into(),
        },
        data: data(),
        crc,
    };
    let mut bytes = Vec::new();
    record_bytes(&attachment(0), false, &mut bytes);
    let attachment = attachment(crc32(&bytes[RECORD_HEAD as usize..bytes.len() - 4]));
    let ten =
        [0, 2, 1, 3, 3, 5, 4, 7, 8, 9].into_iter().zip(0..).map(|(time, number)| message(number, time, time));
    [
        ("NoData", vec![]),
        ("OneSchemalessMessage", vec![channel(0, "text", BTreeMap::new()), message(10, 1, 2)]),
        ("OneMessage", described().into_iter().chain([message(10, 1, 2)]).collect()),
        ("OneAttachment", vec![attachment]),
        ("OneMetadata", vec![Record::Metadata(Metadata { name: "myMetadata".into(), metadata: foo() })]),
        ("TenMessages", described().into_iter().chain(ten).collect()),
    ]
}

/// A file as it grows.
struct File {
    features: Vec<&'static str>,
    bytes: Vec<u8>,
    records: Vec<String>,
    statistics: Statistics,
    /// Records of the summary that point to others, in the order of the summary.
    indexes: Vec<Record<'static>>,
    groups: Vec<SummaryOffset>,
}

impl File {
    fn new(features: Vec<&'static str>) -> Self {
        Self {
            features,
            bytes: mcap::MAGIC.to_vec(),
            records: Vec::new(),
            statistics: Statistics::default(),
            indexes: Vec::new(),
            groups: Vec::new(),
        }
    }

    fn has(&self, feature: &str) -> bool {
        self.features.contains(&feature)
    }

    /// Appends a record; returns its offset and its length.
    fn append(&mut self, record: &Record<'_>) -> (u64, u64) {
        let offset = self.bytes.len();
        record_bytes(record, self.has("pad"), &mut self.bytes);
        (offset as u64, (self.bytes.len() - offset) as u64)
    }

    /// Appends a record that readers report.
    fn append_read(&mut self, record: &Record<'_>) -> (u64, u64) {
        self.records.push(format!("{record:?}"));
        self.append(record)
    }

    fn write(&mut self, records: &[Record<'static>]) {
        self.append_read(&Record::Header(Header { profile: String::new(), library: String::new() }));
        records.iter().for_each(|record| self.count(record));
        if self.has("ch") {
            self.chunk(records);
        } else {
            records.iter().for_each(|record| self.write_indexed(record));
        }
        let data_section_crc = crc32(&self.bytes);
        self.append_read(&Record::DataEnd(DataEnd { data_section_crc }));
        self.summary(records);
    }

    fn count(&mut self, record: &Record<'_>) {
        let counts = &mut self.statistics;
        match record {
            Record::Schema { .. } => counts.schema_count += 1,
            Record::Channel(_) => counts.channel_count += 1,
            Record::Attachment { .. } => counts.attachment_count += 1,
            Record::Metadata(_) => counts.metadata_count += 1,
            Record::Message { header, .. } => {
                let first = if counts.message_count == 0 { u64::MAX } else { counts.message_start_time };
                counts.message_count += 1;
                counts.message_start_time = first.min(header.log_time);
                counts.message_end_time = counts.message_end_time.max(header.log_time);
                *counts.channel_message_counts.entry(header.channel_id).or_default() += 1;
            }
            _ => {}
        }
    }

    /// A record outside chunks, and its index.
    fn write_indexed(&mut self, record: &Record<'_>) {
        let (offset, length) = self.append_read(record);
        match record {
            Record::Attachment { header, data, .. } if self.has("ax") => {
                self.indexes.push(Record::AttachmentIndex(AttachmentIndex {
                    offset,
                    length,
                    log_time: header.log_time,
                    create_time: header.create_time,
                    data_size: data.len() as u64,
                    name: header.name.clone(),
                    media_type: header.media_type.clone(),
                }));
            }
            Record::Metadata(metadata) if self.has("mdx") => {
                let name = metadata.name.clone();
                self.indexes.push(Record::MetadataIndex(MetadataIndex { offset, length, name }));
            }
            _ => {}
        }
    }

    /// One chunk of all records, without compression.
    fn chunk(&mut self, records: &[Record<'_>]) {
        let (mut inside, mut entries) = (Vec::new(), Vec::new());
        for record in records {
            self.records.push(format!("{record:?}"));
            if let Record::Message { header, .. } = record {
                entries.push(MessageIndexEntry { log_time: header.log_time, offset: inside.len() as u64 });
            }
            // Records in chunks are never padded.
            record_bytes(record, false, &mut inside);
        }
        let size = inside.len() as u64;
        self.statistics.chunk_count = 1;
        let times = [self.statistics.message_start_time, self.statistics.message_end_time];
        let header = ChunkHeader {
            message_start_time: times[0],
            message_end_time: times[1],
            uncompressed_size: size,
            uncompressed_crc: crc32(&inside),
            compression: String::new(),
            compressed_size: size,
        };
        let (start, length) = self.append(&Record::Chunk { header, data: inside.into() });
        let (mut offsets, mut index_length) = (BTreeMap::new(), 0);
        if self.has("mx") {
            let index = Record::MessageIndex(MessageIndex { channel_id: 1, records: entries });
            let place = self.append(&index);
            offsets.insert(1, place.0);
            index_length = place.1;
        }
        if self.has("chx") {
            self.indexes.push(Record::ChunkIndex(ChunkIndex {
                message_start_time: times[0],
                message_end_time: times[1],
                chunk_start_offset: start,
                chunk_length: length,
                message_index_offsets: offsets,
                message_index_length: index_length,
                compression: String::new(),
                compressed_size: size,
                uncompressed_size: size,
            }));
        }
    }

    fn summary(&mut self, records: &[Record<'_>]) {
        let start = self.bytes.len();
        for (feature, opcode) in [("rsh", op::SCHEMA), ("rch", op::CHANNEL)] {
            if self.has(feature) {
                let repeated: Vec<_> = records.iter().filter(|record| record.opcode() == opcode).collect();
                self.group(opcode, &repeated);
            }
        }
        if self.has("st") {
            let statistics = Record::Statistics(self.statistics.clone());
            self.group(op::STATISTICS, &[&statistics]);
        }
        let indexes = std::mem::take(&mut self.indexes);
        for opcode in [op::METADATA_INDEX, op::ATTACHMENT_INDEX, op::CHUNK_INDEX] {
            let group: Vec<_> = indexes.iter().filter(|record| record.opcode() == opcode).collect();
            self.group(opcode, &group);
        }
        let has_summary = self.bytes.len() > start;
        let offsets_start = self.bytes.len() as u64;
        let has_offsets = self.has("sum");
        for offset in std::mem::take(&mut self.groups) {
            if has_offsets {
                self.append_read(&Record::SummaryOffset(offset));
            }
        }
        let summary_start = if has_summary { start as u64 } else { 0 };
        let summary_offset_start = if has_offsets { offsets_start } else { 0 };
        let footer =
            |summary_crc| Record::Footer(Footer { summary_start, summary_offset_start, summary_crc });
        // The checksum covers the footer up to itself.
        let end = self.bytes.len();
        record_bytes(&footer(0), false, &mut self.bytes);
        let summary_crc = crc32(&self.bytes[start..self.bytes.len() - 4]);
        self.bytes.truncate(end);
        record_bytes(&footer(summary_crc), false, &mut self.bytes);
        self.bytes.extend(mcap::MAGIC);
    }

    /// Records of one kind, and where they are.
    fn group(&mut self, group_opcode: u8, records: &[&Record<'_>]) {
        let group_start = self.bytes.len() as u64;
        for record in records {
            self.append_read(record);
        }
        let group_length = self.bytes.len() as u64 - group_start;
        if group_length > 0 {
            self.groups.push(SummaryOffset { group_opcode, group_start, group_length });
        }
    }
}
