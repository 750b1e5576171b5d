//! Landmarks: records that can be distinguished from other bytes, namely chunks, metadata of this program, and the end of the data.
//! After damage, reading continues at the next one.

use std::io::{self, Read, Seek, SeekFrom};

use mcap::records::op;

use super::names::METADATA_NAME;

/// Opcode and length before every record, bytes.
pub(crate) const RECORD_HEAD: u64 = 9;

/// Longest head of a chunk's body: times (16 bytes), content size (8), checksum (4), name of the compression (4 and up to 4), size of
/// the records (8).
pub(super) const CHUNK_HEAD: usize = 44;

/// Bytes searched at a time.
const WINDOW: usize = 1 << 18;

/// Content size, bytes, of a chunk whose body begins with `head` and is `length` bytes long; `None` if `head` is not the head of a
/// chunk.
pub(super) fn unpacked_bytes(head: &[u8], length: u64) -> Option<u64> {
    let name_bytes = u32::from_le_bytes(*head.get(28..)?.first_chunk()?);
    let name = head.get(32..)?.get(..name_bytes as usize)?;
    let known: [&[u8]; 3] = [b"", b"lz4", b"zstd"];
    let packed = u64::from_le_bytes(*head.get(32 + name.len()..)?.first_chunk()?);
    let is_head = known.contains(&name) && packed.checked_add(40 + name.len() as u64) == Some(length);
    is_head.then(|| u64::from_le_bytes([16, 17, 18, 19, 20, 21, 22, 23].map(|byte| head[byte])))
}

/// Whether `bytes` begin a landmark (a chunk, our metadata, or the end of data) that ends within `left` bytes.
fn is_landmark(bytes: &[u8], left: u64) -> bool {
    let Some((head, body)) = bytes.split_first_chunk::<{ RECORD_HEAD as usize }>() else { return false };
    let [opcode, length @ ..] = *head;
    let length = u64::from_le_bytes(length);
    let fits = length <= left.saturating_sub(RECORD_HEAD);
    match opcode {
        op::CHUNK => fits && unpacked_bytes(body, length).is_some(),
        // The name follows its length of 4 bytes.
        op::METADATA => fits && body.get(4..).is_some_and(|name| name.starts_with(METADATA_NAME.as_bytes())),
        op::DATA_END => fits && length == 4,
        _ => false,
    }
}

/// Offset of the first landmark record at or after `from`, in a file of `length` bytes.
pub(super) fn find(file: &mut (impl Read + Seek), from: u64, length: u64) -> io::Result<Option<u64>> {
    let mut window = Vec::new();
    let mut start = from;
    loop {
        file.seek(SeekFrom::Start(start))?;
        window.clear();
        file.by_ref().take(WINDOW as u64).read_to_end(&mut window)?;
        let found = (0..window.len()).find(|at| {
            matches!(window[*at], op::CHUNK | op::METADATA | op::DATA_END)
                && is_landmark(&window[*at..], length - start - *at as u64)
        });
        if let Some(at) = found {
            return Ok(Some(start + at as u64));
        }
        if window.len() < WINDOW {
            return Ok(None);
        }
        // A head may lie across the end of the window.
        start += (WINDOW - CHUNK_HEAD - RECORD_HEAD as usize) as u64;
    }
}
