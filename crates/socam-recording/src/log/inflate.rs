//! Decompresses chunks in Rust, for targets on which the mcap crate has no decompressor.

use std::io::Read;

use mcap::records::{Record, op};

/// The body of a chunk without compression; `None` when it is damaged. The checksum, which is of the uncompressed records, is kept.
pub(super) fn inflated(body: &[u8]) -> Option<Vec<u8>> {
    let Some(Record::Chunk { header, data }) = super::parse::record(op::CHUNK, body) else { return None };
    let mut records = Vec::new();
    let most = header.uncompressed_size;
    let read = match header.compression.as_str() {
        "" => return Some(body.to_vec()),
        "zstd" => ruzstd::decoding::StreamingDecoder::new(&*data).ok()?.take(most).read_to_end(&mut records),
        "lz4" => lz4_flex::frame::FrameDecoder::new(&*data).take(most).read_to_end(&mut records),
        _ => return None,
    };
    (read.ok()? as u64 == most).then_some(())?;
    let mut plain = Vec::with_capacity(records.len() + 40);
    plain.extend(header.message_start_time.to_le_bytes());
    plain.extend(header.message_end_time.to_le_bytes());
    plain.extend(most.to_le_bytes());
    plain.extend(header.uncompressed_crc.to_le_bytes());
    // An empty name means no compression.
    plain.extend(0_u32.to_le_bytes());
    plain.extend((records.len() as u64).to_le_bytes());
    plain.extend(records);
    Some(plain)
}
