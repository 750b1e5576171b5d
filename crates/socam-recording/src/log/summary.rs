//! Schemas and channels that a log repeats in its summary, for a log whose first chunk is damaged.

use std::path::Path;

use mcap::records::op;

use super::records::{Next, Records};
use crate::error::Result;

/// Opcode and body of each schema and channel of the summary; none in a log that is cut off.
pub(super) fn topics(path: &Path) -> Result<Vec<(u8, Vec<u8>)>> {
    let mut records = Records::open(path)?;
    let mut topics = Vec::new();
    let mut is_summary = false;
    loop {
        let wanted = |opcode| is_summary && matches!(opcode, op::SCHEMA | op::CHANNEL);
        match records.next(wanted)? {
            Next::Record { opcode: op::DATA_END, .. } => is_summary = true,
            Next::Record { opcode, body, .. } if wanted(opcode) => topics.push((opcode, body.clone())),
            Next::Record { .. } | Next::Damaged(..) => {}
            Next::End | Next::Cut(_) => return Ok(topics),
        }
    }
}
