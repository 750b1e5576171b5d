//! Encodes messages as frames.

use core::fmt;

use crc::{CRC_32_ISCSI, Crc, Table};
use serde::Serialize;

use crate::SCHEMA_VERSION;

/// Longest encoded message: a full batch of eight channels (736 bytes) and its header.
pub(crate) const MAX_PAYLOAD: usize = 768;
/// Version, its complement and the sequence number.
pub(crate) const HEAD: usize = 6;
/// The checksum.
pub(crate) const TAIL: usize = 4;
pub(crate) const MAX_RAW: usize = HEAD + MAX_PAYLOAD + TAIL;
/// Longest frame: COBS adds a byte per 254 and one more, and there is a zero on both sides.
pub const MAX_FRAME: usize = MAX_RAW + MAX_RAW / 254 + 1 + 2;

/// CRC-32C: it detects every error of up to five bits in frames of this length.
pub(crate) static CHECKSUM: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISCSI);

/// The buffer does not hold the frame; [`MAX_FRAME`] bytes always do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BufferTooSmall;

impl fmt::Display for BufferTooSmall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the buffer does not hold the frame; {MAX_FRAME} bytes always do")
    }
}

impl core::error::Error for BufferTooSmall {}

/// The sending end of a link; it numbers the frames.
#[derive(Debug, Clone, Default)]
pub struct Encoder {
    seq: u32,
}

impl Encoder {
    /// Creates an encoder whose first frame has number 0.
    pub fn new() -> Self {
        Self::default()
    }

    /// Writes `message` as the next frame to the beginning of `out`, and returns its length.
    pub fn encode<M: Serialize>(&mut self, message: &M, out: &mut [u8]) -> Result<usize, BufferTooSmall> {
        let mut raw = [0; MAX_RAW];
        let len = fill(&mut raw, self.seq, message).ok_or(BufferTooSmall)?;
        let raw = raw.get(..len).ok_or(BufferTooSmall)?;
        let (first, rest) = out.split_first_mut().ok_or(BufferTooSmall)?;
        *first = 0;
        let len = cobs::try_encode(raw, rest).map_err(|_| BufferTooSmall)?;
        *rest.get_mut(len).ok_or(BufferTooSmall)? = 0;
        self.seq = self.seq.wrapping_add(1);
        Ok(len + 2)
    }
}

fn fill<M: Serialize>(raw: &mut [u8; MAX_RAW], seq: u32, message: &M) -> Option<usize> {
    let (head, rest) = raw.split_first_chunk_mut::<HEAD>()?;
    let [s0, s1, s2, s3] = seq.to_le_bytes();
    *head = [SCHEMA_VERSION, !SCHEMA_VERSION, s0, s1, s2, s3];
    let payload = postcard::to_slice(message, rest.get_mut(..MAX_PAYLOAD)?).ok()?.len();
    let end = HEAD + payload;
    let checksum = CHECKSUM.checksum(raw.get(..end)?);
    raw.get_mut(end..end + TAIL)?.copy_from_slice(&checksum.to_le_bytes());
    Some(end + TAIL)
}
