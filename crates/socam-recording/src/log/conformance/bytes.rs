//! Records in bytes, written from the specification and not by the library that reads them.

use std::collections::BTreeMap;

use mcap::records::Record;

/// Bytes that the suite appends to a record to check that readers ignore them.
const PAD: [u8; 3] = [0x01, 0xff, 0xff];

/// Appends a record. A message ends with its data, and chunks, ends of data and footers have a fixed form: they are never padded.
pub(super) fn record_bytes(record: &Record<'_>, pad: bool, bytes: &mut Vec<u8>) {
    let mut body = Body(Vec::new());
    data_body(record, &mut body);
    let is_exact = matches!(
        record,
        Record::Message { .. } | Record::Chunk { .. } | Record::DataEnd(_) | Record::Footer(_)
    );
    if pad && !is_exact {
        body.raw(&PAD);
    }
    bytes.push(record.opcode());
    bytes.extend((body.0.len() as u64).to_le_bytes());
    bytes.extend(body.0);
}

/// The content of a record of the data section.
fn data_body<'b>(record: &Record<'_>, body: &'b mut Body) -> &'b mut Body {
    match record {
        Record::Header(r) => body.text(&r.profile).text(&r.library),
        Record::Schema { header: r, data } => body.u16(r.id).text(&r.name).text(&r.encoding).blob(data),
        Record::Channel(r) => {
            body.u16(r.id).u16(r.schema_id).text(&r.topic).text(&r.message_encoding).texts(&r.metadata)
        }
        Record::Message { header: r, data } => {
            body.u16(r.channel_id).u32(r.sequence).u64(r.log_time).u64(r.publish_time).raw(data)
        }
        Record::Chunk { header: r, data } => {
            body.u64(r.message_start_time).u64(r.message_end_time).u64(r.uncompressed_size);
            body.u32(r.uncompressed_crc).text(&r.compression).u64(r.compressed_size).raw(data)
        }
        Record::MessageIndex(r) => {
            let mut entries = Body(Vec::new());
            for entry in &r.records {
                entries.u64(entry.log_time).u64(entry.offset);
            }
            body.u16(r.channel_id).blob(&entries.0)
        }
        Record::Attachment { header: r, data, crc } => {
            body.u64(r.log_time).u64(r.create_time).text(&r.name).text(&r.media_type);
            body.u64(data.len() as u64).raw(data).u32(*crc)
        }
        Record::Metadata(r) => body.text(&r.name).texts(&r.metadata),
        Record::DataEnd(r) => body.u32(r.data_section_crc),
        _ => summary_body(record, body),
    }
}

/// The content of a record of the summary.
fn summary_body<'b>(record: &Record<'_>, body: &'b mut Body) -> &'b mut Body {
    match record {
        Record::ChunkIndex(r) => {
            body.u64(r.message_start_time).u64(r.message_end_time).u64(r.chunk_start_offset);
            body.u64(r.chunk_length).numbers(&r.message_index_offsets).u64(r.message_index_length);
            body.text(&r.compression).u64(r.compressed_size).u64(r.uncompressed_size)
        }
        Record::AttachmentIndex(r) => {
            body.u64(r.offset).u64(r.length).u64(r.log_time).u64(r.create_time).u64(r.data_size);
            body.text(&r.name).text(&r.media_type)
        }
        Record::Statistics(r) => {
            body.u64(r.message_count).u16(r.schema_count).u32(r.channel_count).u32(r.attachment_count);
            body.u32(r.metadata_count).u32(r.chunk_count).u64(r.message_start_time).u64(r.message_end_time);
            body.numbers(&r.channel_message_counts)
        }
        Record::MetadataIndex(r) => body.u64(r.offset).u64(r.length).text(&r.name),
        Record::SummaryOffset(r) => body.raw(&[r.group_opcode]).u64(r.group_start).u64(r.group_length),
        Record::Footer(r) => body.u64(r.summary_start).u64(r.summary_offset_start).u32(r.summary_crc),
        _ => body,
    }
}

struct Body(Vec<u8>);

impl Body {
    fn raw(&mut self, bytes: &[u8]) -> &mut Self {
        self.0.extend(bytes);
        self
    }

    fn u16(&mut self, number: u16) -> &mut Self {
        self.raw(&number.to_le_bytes())
    }

    fn u32(&mut self, number: u32) -> &mut Self {
        self.raw(&number.to_le_bytes())
    }

    fn u64(&mut self, number: u64) -> &mut Self {
        self.raw(&number.to_le_bytes())
    }

    /// Bytes after their count.
    fn blob(&mut self, bytes: &[u8]) -> &mut Self {
        self.u32(bytes.len() as u32).raw(bytes)
    }

    fn text(&mut self, text: &str) -> &mut Self {
        self.blob(text.as_bytes())
    }

    fn texts(&mut self, map: &BTreeMap<String, String>) -> &mut Self {
        let mut pairs = Self(Vec::new());
        for (name, text) in map {
            pairs.text(name).text(text);
        }
        self.blob(&pairs.0)
    }

    fn numbers(&mut self, map: &BTreeMap<u16, u64>) -> &mut Self {
        let mut pairs = Self(Vec::new());
        for (id, number) in map {
            pairs.u16(*id).u64(*number);
        }
        self.blob(&pairs.0)
    }
}
