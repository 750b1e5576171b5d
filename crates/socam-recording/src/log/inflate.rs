//! Decompresses in Rust what the mcap crate would decompress by libraries in C: LZ4 always, for these take long to compile, and Zstandard
//! where there is no C.

use std::borrow::Cow;
use std::io::Read;

use mcap::records::{Record, op};

/// The body of a chunk as the mcap crate reads it; `None` when it is damaged. The checksum, which is of the uncompressed records, is kept.
pub(super) fn inflated(body: &[u8]) -> Option<Cow<'_, [u8]>> {
    let Some(Record::Chunk { header, data }) = super::parse::record(op::CHUNK, body) else { return None };
    let mut records = Vec::new();
    let most = header.uncompressed_size;
    let read = match header.compression.as_str() {
        #[cfg(not(target_arch = "wasm32"))]
        "zstd" => return Some(body.into()),
        #[cfg(target_arch = "wasm32")]
        "zstd" => ruzstd::decoding::StreamingDecoder::new(&*data).ok()?.take(most).read_to_end(&mut records),
        "lz4" => lz4_flex::frame::FrameDecoder::new(&*data).take(most).read_to_end(&mut records),
        // The chunk is not compressed, or by a method that the mcap crate refuses.
        _ => return Some(body.into()),
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
    Some(plain.into())
}
