//! Reads a log record by record: memory stays at one chunk, and a log cut off or damaged anywhere gives all that is whole.

use std::path::Path;

use mcap::records::{Record, op};
use rayon::prelude::*;

use super::LogContents;
use super::decode::{Decoder, LogLayout, SampleDecoder, Sequel};
use super::records::{ChunkOpener, Next, RECORD_HEAD, Records};
use super::writer::Attachment;
use crate::Channel;
use crate::dataset::{BLOCK_ROWS, Cut, Warning};
use crate::error::{RecordingError, Result};
use crate::rows::{EndOfRows, Layout, Part, Place};
use crate::table::Table;

/// Attachments of a log, with their content, in the file's order.
///
/// # Errors
/// When the file cannot be read or is no MCAP log. Attachments after a cut are not there.
pub fn read_attachments(path: &Path) -> Result<Vec<Attachment>> {
    let mut records = Records::open(path)?;
    let mut attachments = Vec::new();
    while let Next::Record { opcode, body, .. } = records.next(|opcode| opcode == op::ATTACHMENT)? {
        if opcode == op::ATTACHMENT
            && let Ok(Record::Attachment { header, data, .. }) = mcap::parse_record(opcode, body)
        {
            attachments.push(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            });
        }
    }
    Ok(attachments)
}

/// Chunks unpacked at a time: as many as fit into this, but not more than [`BATCH`].
const BATCH_BYTES: usize = 8 << 20;

/// See [`BATCH_BYTES`].
const BATCH: usize = 64;

/// A first reading of a log: all samples and everything else that is in it. Chunks are unpacked on all cores and put
/// together in their order.
pub(crate) struct LogScan {
    records: Records,
    decoder: Decoder,
    /// Of all samples so far.
    sequel: Sequel,
    /// Unpacked and not given out yet.
    ready: Vec<Part>,
    /// Buffers to use again.
    spare: Vec<Vec<u8>>,
    ended: bool,
    cut: Option<u64>,
    damaged: Vec<(u64, u64)>,
    samples_whole: bool,
}

/// Consecutive records: one chunk, or some that stand outside of chunks.
struct Group {
    byte: u64,
    records: Vec<Raw>,
}

struct Raw {
    opcode: u8,
    byte: u64,
    body: Vec<u8>,
}

/// What a group held.
struct Unpacked {
    byte: u64,
    end_byte: u64,
    table: Table,
    sequel: Sequel,
    /// All records but samples.
    others: Vec<(u8, Vec<u8>)>,
    /// Where it is damaged: first byte and length.
    damaged: Vec<(u64, u64)>,
}

impl Group {
    fn unpack(&self, samples: &mut SampleDecoder, chunks: &mut ChunkOpener) -> Unpacked {
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
        let sequel = samples.hand_over(&mut table);
        Unpacked { byte: self.byte, end_byte, table, sequel, others, damaged }
    }
}

impl LogScan {
    /// Reads up to the first samples.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let mut scan = Self {
            records: Records::open(path)?,
            decoder: Decoder::default(),
            sequel: Sequel::default(),
            ready: Vec::new(),
            spare: Vec::new(),
            ended: false,
            cut: None,
            damaged: Vec::new(),
            samples_whole: false,
        };
        while scan.decoder.layout.is_none() && !scan.ended {
            scan.look_for_samples()?;
        }
        if scan.decoder.layout.is_none() {
            return Err(scan.without_samples());
        }
        Ok(scan)
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

    /// Takes one record while it is not known yet which are samples.
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
                // The same record may hold the first of them.
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

    /// Some whole records as they are in the file.
    fn batch(&mut self) -> Result<Vec<Group>> {
        let mut groups: Vec<Group> = Vec::new();
        let mut bytes = 0;
        while groups.len() < BATCH && bytes < BATCH_BYTES {
            let Some(record) = self.next_record()? else { break };
            bytes += record.body.len();
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
        self.sequel.append(&group.sequel);
        self.sequel.check_order().map_err(|problem| RecordingError::Byte {
            path: self.records.path.clone(),
            byte: group.byte,
            problem,
        })?;
        if group.table.rows() > 0 {
            let place = Place { byte: group.byte, line: 0 };
            self.ready.push(Part { place, end_byte: group.end_byte, table: group.table });
        }
        Ok(())
    }

    /// The next record of those that matter; `None` at the end of the data, whole or cut.
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
                // What follows repeats what was read. Only its end tells whether the file is whole.
                Next::Record { opcode: op::DATA_END, .. } => self.skip_summary()?,
                Next::Record { opcode, byte, body } if wanted(opcode) => {
                    let body = std::mem::replace(body, self.spare.pop().unwrap_or_default());
                    return Ok(Some(Raw { opcode, byte, body }));
                }
                Next::Record { .. } => {}
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
                Next::Record { .. } => {}
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

    fn without_samples(&self) -> RecordingError {
        let path = self.records.path.clone();
        let topics = &self.decoder.topics;
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

    pub(crate) fn finish(self) -> EndOfRows {
        let lost_samples = self.sequel.lost;
        let mut warnings = self.decoder.warnings;
        if lost_samples > 0 {
            warnings.push(Warning::LostSamples { samples: lost_samples });
        }
        warnings.extend(self.damaged.into_iter().map(|(byte, bytes)| Warning::Damaged { byte, bytes }));
        let contents = self.decoder.contents;
        let cut = self.cut.map(|byte| Cut {
            byte,
            unused_bytes: self.records.length - byte,
            missing: if self.samples_whole {
                "only the index at its end, all samples are there".into()
            } else {
                missing(&contents, self.sequel.last_s())
            },
        });
        warnings.extend(cut.iter().map(|cut| Warning::CutOff { missing: cut.missing.clone() }));
        EndOfRows {
            layout: Layout::Log(self.decoder.layout.unwrap_or_default()),
            unusable: Vec::new(),
            warnings,
            lost_samples,
            cut,
            contents: Some(contents),
        }
    }
}

/// What a cut recording lacks, as far as can be known.
fn missing(contents: &LogContents, last_s: Option<f64>) -> String {
    let last_s = last_s.unwrap_or(0.0);
    let rest = match contents.planned_duration_s {
        Some(planned_s) if planned_s > last_s => {
            format!("the last {:.3} s of the planned {planned_s} s", planned_s - last_s)
        }
        _ => format!("all after {last_s} s (of a running recording, at most its last second)"),
    };
    format!("{rest}, and the index at its end")
}

/// A second reading: some channels' samples from a record on, nothing else.
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

    /// Appends the rows of whole records, at least `rows` of them; false once there are no more.
    pub(crate) fn read(&mut self, table: &mut Table, rows: usize) -> Result<bool> {
        let enough = table.rows() + rows;
        while table.rows() < enough {
            let wanted = |opcode| matches!(opcode, op::CHUNK | op::MESSAGE | op::DATA_END);
            let Next::Record { opcode, byte, body } = self.records.next(wanted)? else { return Ok(false) };
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
            let sequel = samples.hand_over(table);
            sequel.check_order().map_err(|problem| RecordingError::Byte {
                path: self.records.path.clone(),
                byte,
                problem,
            })?;
        }
        Ok(true)
    }
}
