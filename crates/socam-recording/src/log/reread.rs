//! Reads some channels of a log again, from any record on.

use std::path::Path;

use mcap::records::op;

use super::decode::{LogLayout, SampleDecoder};
use super::records::{ChunkOpener, Next, Records};
use crate::error::{RecordingError, Result};
use crate::part::Place;
use crate::table::Table;

/// A further reading: samples of some channels, from a record on.
pub(crate) struct LogSamples {
    records: Records,
    chunks: ChunkOpener,
    samples: SampleDecoder,
}

impl LogSamples {
    pub(crate) fn resume(path: &Path, layout: &LogLayout, columns: &[usize], place: Place) -> Result<Self> {
        let mut records = Records::open(path)?;
        records.seek(place.byte)?;
        Ok(Self { records, chunks: ChunkOpener::new(), samples: layout.decoder(columns) })
    }

    /// Appends the rows of whole records, at least `rows` of them; false after the last one.
    pub(crate) fn read(&mut self, table: &mut Table, rows: usize) -> Result<bool> {
        let enough = table.rows() + rows;
        while table.rows() < enough {
            let wanted = |opcode| matches!(opcode, op::CHUNK | op::MESSAGE | op::DATA_END);
            let (opcode, byte, body) = match self.records.next(wanted)? {
                Next::Record { opcode, byte, body } => (opcode, byte, body),
                Next::Damaged(..) => continue,
                Next::End | Next::Cut(_) => return Ok(false),
            };
            let samples = &mut self.samples;
            let mut take = |opcode, body: &[u8]| match opcode {
                op::MESSAGE => samples.message(body).map(drop),
                _ => Some(()),
            };
            let whole = match opcode {
                op::CHUNK => self.chunks.open(body, take),
                op::DATA_END => return Ok(false),
                _ => take(opcode, body),
            };
            if whole.is_none() {
                samples.discard();
            }
            let order = samples.hand_over(table);
            order.check().map_err(|problem| RecordingError::Byte {
                path: self.records.path.clone(),
                byte,
                problem,
            })?;
        }
        Ok(true)
    }
}
