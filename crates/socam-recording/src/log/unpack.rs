//! Unpacks groups of records, each on a core of its own.

use mcap::records::op;

use super::decode::SampleDecoder;
use super::landmark;
use super::landmark::RECORD_HEAD;
use super::order::SampleOrder;
use super::records::ChunkOpener;
use crate::table::Table;

/// Consecutive records: one chunk, or some outside chunks.
pub(super) struct Group {
    /// Offset of the first record, bytes.
    pub(super) byte: u64,
    pub(super) records: Vec<Raw>,
}

/// A record as it is in the file.
pub(super) struct Raw {
    pub(super) opcode: u8,
    pub(super) byte: u64,
    pub(super) body: Vec<u8>,
}

impl Raw {
    /// Length of its content when it is unpacked, bytes.
    pub(super) fn unpacked_bytes(&self) -> u64 {
        let length = self.body.len() as u64;
        let is_chunk = self.opcode == op::CHUNK;
        is_chunk.then(|| landmark::unpacked_bytes(&self.body, length)).flatten().unwrap_or(length)
    }
}

/// The contents of a group.
pub(super) struct Unpacked {
    pub(super) byte: u64,
    pub(super) end_byte: u64,
    pub(super) table: Table,
    pub(super) order: SampleOrder,
    /// Opcode and body of all records but samples.
    pub(super) others: Vec<(u8, Vec<u8>)>,
    /// First byte and length of each damaged part.
    pub(super) damaged: Vec<(u64, u64)>,
}

impl Group {
    pub(super) fn unpack(&self, samples: &mut SampleDecoder, chunks: &mut ChunkOpener) -> Unpacked {
        let mut others = Vec::new();
        let mut damaged = Vec::new();
        let mut end_byte = self.byte;
        for Raw { opcode, byte, body } in &self.records {
            let before = others.len();
            let length = body.len() as u64 + RECORD_HEAD;
            end_byte = byte + length;
            let mut take = |opcode: u8, body: &[u8]| {
                if opcode != op::MESSAGE || !samples.message(body)? {
                    others.push((opcode, body.to_vec()));
                }
                Some(())
            };
            let whole = if *opcode == op::CHUNK { chunks.open(body, take) } else { take(*opcode, body) };
            if whole.is_none() {
                if *opcode == op::CHUNK {
                    samples.discard();
                    others.truncate(before);
                }
                damaged.push((*byte, length));
            }
        }
        let mut table = samples.table();
        let order = samples.hand_over(&mut table);
        Unpacked { byte: self.byte, end_byte, table, order, others, damaged }
    }
}
