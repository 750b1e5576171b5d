//! The first reading of a log, in batches of chunks: a log cut off or damaged anywhere gives all records that are whole.

use std::path::Path;

use mcap::records::op;
use rayon::prelude::*;

use super::decode::{Decoder, LogLayout};
use super::landmark::RECORD_HEAD;
use super::order::SampleOrder;
use super::records::{ChunkOpener, Next, Records};
use super::unpack::{Group, Raw, Unpacked};
use crate::Channel;
use crate::error::{RecordingError, Result};
use crate::part::{EndOfRows, Part, Place};
use crate::table::BLOCK_ROWS;
use crate::warning::{self, Cut, Warning};

/// Bytes of the contents of chunks unpacked at a time, and of the rows that they can hold at most; at most [`BATCH`] chunks.
const BATCH_BYTES: u64 = 32 << 20;

/// Bytes of the shortest message with its head.
const SHORTEST_MESSAGE: u64 = 31;

/// Most chunks unpacked at a time.
const BATCH: usize = 64;

/// A first reading of a log: all samples and all other records. Chunks are unpacked on all cores and kept in order.
pub(crate) struct LogScan {
    records: Records,
    decoder: Decoder,
    /// Order of all samples so far.
    order: SampleOrder,
    /// Number of samples so far.
    rows: u64,
    /// Tables unpacked and not returned yet.
    ready: Vec<Part>,
    /// Buffers to reuse.
    spare: Vec<Vec<u8>>,
    ended: bool,
    cut: Option<u64>,
    damaged: Vec<(u64, u64)>,
    samples_whole: bool,
}

impl LogScan {
    /// Reads up to the first samples.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let mut scan = Self::start(path, &[])?;
        while scan.decoder.layout.is_none() && !scan.ended {
            scan.look_for_samples()?;
        }
        if scan.decoder.layout.is_none() && scan.samples_whole {
            let topics = super::summary::topics(path)?;
            let from_summary = Self::start(path, &topics)?;
            if from_summary.decoder.layout.is_some() {
                return Ok(from_summary);
            }
        }
        if scan.decoder.layout.is_none() {
            return Err(scan.without_samples());
        }
        Ok(scan)
    }

    /// A reading of which schemas and channels are known beforehand.
    fn start(path: &Path, topics: &[(u8, Vec<u8>)]) -> Result<Self> {
        let mut decoder = Decoder::default();
        // One that cannot be decoded is as good as absent.
        for (opcode, body) in topics {
            let _ = decoder.take(*opcode, body);
        }
        Ok(Self {
            records: Records::open(path)?,
            decoder,
            order: SampleOrder::default(),
            rows: 0,
            ready: Vec::new(),
            spare: Vec::new(),
            ended: false,
            cut: None,
            damaged: Vec::new(),
            samples_whole: false,
        })
    }

    pub(crate) fn channels(&self) -> &[Channel] {
        &self.decoder.channels
    }

    /// The rows of some more records.
    pub(crate) fn next(&mut self) -> Result<Vec<Part>> {
        while self.ready.is_empty() && !self.ended {
            self.fill()?;
        }
        Ok(std::mem::take(&mut self.ready))
    }

    /// Decodes one record while the samples' topic is unknown.
    fn look_for_samples(&mut self) -> Result<()> {
        let Some(record) = self.next_record()? else { return Ok(()) };
        let (decoder, mut chunks) = (&mut self.decoder, ChunkOpener::new());
        let whole = if record.opcode == op::CHUNK {
            chunks.open(&record.body, |opcode, body| decoder.take(opcode, body))
        } else {
            decoder.take(record.opcode, &record.body)
        };
        match &decoder.layout {
            None if whole.is_none() => {
                self.damaged.push((record.byte, record.body.len() as u64 + RECORD_HEAD));
                Ok(())
            }
            None => Ok(()),
            Some(layout) => {
                // The same chunk may hold the first samples.
                let group = Group { byte: record.byte, records: vec![record] };
                let mut unpacked = group.unpack(&mut layout.decoder_of_all(), &mut chunks);
                unpacked.others.clear();
                self.take(unpacked)
            }
        }
    }

    /// Unpacks some more records.
    fn fill(&mut self) -> Result<()> {
        let Some(layout) = self.decoder.layout.clone() else { return Ok(()) };
        let groups = self.batch()?;
        let tools = || (layout.decoder_of_all(), ChunkOpener::new());
        let unpacked: Vec<Unpacked> = groups
            .par_iter()
            .map_init(tools, |(samples, chunks), group| group.unpack(samples, chunks))
            .collect();
        self.spare.extend(groups.into_iter().flat_map(|group| group.records).map(|record| record.body));
        unpacked.into_iter().try_for_each(|group| self.take(group))
    }

    /// The next whole records, in groups.
    fn batch(&mut self) -> Result<Vec<Group>> {
        let mut groups: Vec<Group> = Vec::new();
        let mut bytes = 0;
        let row_bytes = 8 * (1 + self.decoder.channels.len() as u64);
        while groups.len() < BATCH && bytes < BATCH_BYTES {
            let Some(record) = self.next_record()? else { break };
            let content = record.unpacked_bytes();
            bytes += content + content / SHORTEST_MESSAGE * row_bytes;
            match groups.last_mut() {
                Some(Group { records, .. })
                    if record.opcode != op::CHUNK
                        && records[0].opcode != op::CHUNK
                        && records.len() < BLOCK_ROWS =>
                {
                    records.push(record);
                }
                _ => groups.push(Group { byte: record.byte, records: vec![record] }),
            }
        }
        Ok(groups)
    }

    /// Appends a group to what came before it.
    fn take(&mut self, group: Unpacked) -> Result<()> {
        for (opcode, body) in &group.others {
            if self.decoder.take(*opcode, body).is_none() {
                let note =
                    format!("a record at or after byte {} cannot be read and is left aside", group.byte);
                self.decoder.warnings.push(Warning::Note(note));
            }
        }
        self.damaged.extend(&group.damaged);
        self.order.append(&group.order);
        self.order.check().map_err(|problem| RecordingError::Byte {
            path: self.records.path.clone(),
            byte: group.byte,
            problem,
        })?;
        self.rows += group.table.rows() as u64;
        if group.table.rows() > 0 {
            let place = Place { byte: group.byte, line: 0 };
            self.ready.push(Part { place, end_byte: group.end_byte, table: group.table });
        }
        Ok(())
    }

    /// The next record of a kind that is decoded; `None` at the end of the data, whole or cut.
    fn next_record(&mut self) -> Result<Option<Raw>> {
        let wanted = |opcode| {
            matches!(
                opcode,
                op::HEADER
                    | op::CHUNK
                    | op::SCHEMA
                    | op::CHANNEL
                    | op::MESSAGE
                    | op::METADATA
                    | op::ATTACHMENT
                    | op::DATA_END
            )
        };
        while !self.ended {
            match self.records.next(wanted)? {
                // The summary repeats what was read; only its end shows whether the file is whole.
                Next::Record { opcode: op::DATA_END, .. } => self.skip_summary()?,
                Next::Record { opcode, byte, body } if wanted(opcode) => {
                    let body = std::mem::replace(body, self.spare.pop().unwrap_or_default());
                    return Ok(Some(Raw { opcode, byte, body }));
                }
                Next::Record { .. } => {}
                Next::Damaged(byte, bytes) => self.damaged.push((byte, bytes)),
                Next::End => self.ended = true,
                Next::Cut(byte) => {
                    self.ended = true;
                    self.cut = Some(byte);
                }
            }
        }
        Ok(None)
    }

    fn skip_summary(&mut self) -> Result<()> {
        self.samples_whole = true;
        loop {
            match self.records.next(|_| false)? {
                Next::Record { .. } | Next::Damaged(..) => {}
                Next::End => break,
                Next::Cut(byte) => {
                    self.cut = Some(byte);
                    break;
                }
            }
        }
        self.ended = true;
        Ok(())
    }

    fn damage(&self) -> Vec<Warning> {
        self.damaged.iter().map(|&(byte, bytes)| Warning::Damaged { byte, bytes }).collect()
    }

    fn without_samples(&self) -> RecordingError {
        let path = self.records.path.clone();
        let topics = &self.decoder.topics;
        if let Some(damage) = warning::damage(&self.damage()) {
            return RecordingError::AllDamaged { path, damage };
        }
        if let Some(byte) = self.cut
            && topics.is_empty()
        {
            return RecordingError::Byte {
                path,
                byte,
                problem: "the log is cut off here, before anything was recorded; record again".into(),
            };
        }
        RecordingError::ForeignMcap {
            path,
            topics: if topics.is_empty() { "none".into() } else { topics.join(", ") },
        }
    }

    /// The layout, and what else is known at the end.
    pub(crate) fn finish(self) -> (LogLayout, EndOfRows) {
        let damage = self.damage();
        let mut warnings = self.decoder.warnings;
        warnings.extend(absent(self.order.lost, !damage.is_empty(), self.decoder.counts));
        // Sequence numbers do not show what is missing at the end.
        let [written, lost] = self.decoder.counts.unwrap_or_default();
        let unread = written.saturating_sub(self.rows);
        if unread > 0 {
            warnings.push(Warning::MissingSamples { written, read: self.rows });
        }
        let lost_samples =
            if unread > 0 { self.order.lost.max(lost.saturating_add(unread)) } else { self.order.lost };
        warnings.extend(damage);
        let contents = self.decoder.contents;
        let cut = self.cut.map(|byte| Cut {
            byte,
            unused_bytes: self.records.length - byte,
            missing: if self.samples_whole {
                "only the index at its end, all samples are there".into()
            } else {
                contents.missing_after(self.order.last_s())
            },
        });
        warnings.extend(cut.iter().map(|cut| Warning::CutOff { missing: cut.missing.clone() }));
        let end = EndOfRows { unusable: Vec::new(), warnings, lost_samples, cut, contents: Some(contents) };
        (self.decoder.layout.unwrap_or_default(), end)
    }
}

/// What became of the samples that are absent by their sequence numbers. Those in damaged parts were recorded: only the log's summary, of
/// samples written and lost, tells how many were not.
fn absent(samples: u64, is_damaged: bool, counts: Option<[u64; 2]>) -> Option<Warning> {
    let lost = match counts {
        Some([_, lost]) if is_damaged => lost.min(samples),
        None if is_damaged && samples > 0 => return Some(Warning::AbsentSamples { samples }),
        _ => samples,
    };
    (lost > 0).then_some(Warning::LostSamples { samples: lost })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_a_damaged_log_were_not_lost_while_recording() {
        assert_eq!(absent(0, true, None), None);
        assert_eq!(absent(500, false, Some([9500, 500])), Some(Warning::LostSamples { samples: 500 }));
        assert_eq!(absent(500, true, Some([10_000, 0])), None);
        assert_eq!(absent(500, true, Some([9990, 10])), Some(Warning::LostSamples { samples: 10 }));
        assert_eq!(absent(500, true, None), Some(Warning::AbsentSamples { samples: 500 }));
    }
}
