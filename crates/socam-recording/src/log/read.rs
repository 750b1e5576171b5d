//! Reads a log record by record: memory stays at one chunk, and a log cut off or damaged anywhere gives all that is whole.

use std::path::Path;

use mcap::records::{Record, op};

use super::LogContents;
use super::decode::{Decoder, LogLayout, SampleDecoder};
use super::records::{ChunkOpener, Next, RECORD_HEAD, Records};
use super::writer::Attachment;
use crate::Channel;
use crate::dataset::{Cut, Warning};
use crate::error::{RecordingError, Result};
use crate::rows::{EndOfRows, Layout, Place};
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

/// A first reading of a log: all samples and everything else that is in it.
pub(crate) struct LogScan {
    records: Records,
    chunks: ChunkOpener,
    decoder: Decoder,
    /// Rows decoded while looking for the first, and where their record starts.
    first: Table,
    first_byte: u64,
    ended: bool,
    cut: Option<u64>,
    damaged: Vec<(u64, u64)>,
    samples_whole: bool,
}

impl LogScan {
    /// Reads up to the first samples.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let mut scan = Self {
            records: Records::open(path)?,
            chunks: ChunkOpener::new(),
            decoder: Decoder::default(),
            first: Table::default(),
            first_byte: 0,
            ended: false,
            cut: None,
            damaged: Vec::new(),
            samples_whole: false,
        };
        while scan.first.rows() == 0 && !scan.ended {
            scan.first_byte = scan.records.position;
            let mut first = Table::default();
            scan.advance(&mut first)?;
            scan.first = first;
        }
        if scan.decoder.samples.is_none() {
            return Err(scan.without_samples());
        }
        Ok(scan)
    }

    pub(crate) fn channels(&self) -> &[Channel] {
        &self.decoder.channels
    }

    pub(crate) fn place(&self) -> Place {
        let byte = if self.first.rows() > 0 { self.first_byte } else { self.records.position };
        Place { byte, line: 0 }
    }

    /// Appends the rows of whole records, at least `rows` of them; false once there are no more.
    pub(crate) fn read(&mut self, table: &mut Table, rows: usize) -> Result<bool> {
        let enough = table.rows() + rows;
        if self.first.rows() > 0 {
            table.append(&self.first);
            self.first = Table::default();
        }
        while table.rows() < enough && !self.ended {
            self.advance(table)?;
        }
        Ok(!self.ended)
    }

    /// Reads one record.
    fn advance(&mut self, table: &mut Table) -> Result<()> {
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
        let (opcode, byte, body) = match self.records.next(wanted)? {
            Next::Record { opcode, byte, body } => (opcode, byte, body),
            Next::End => {
                self.ended = true;
                return Ok(());
            }
            Next::Cut(byte) => {
                self.ended = true;
                self.cut = Some(byte);
                return Ok(());
            }
        };
        if !wanted(opcode) {
            return Ok(());
        }
        if opcode == op::DATA_END {
            // What follows repeats what was read. Only its end tells whether the file is whole.
            return self.skip_summary();
        }
        let decoder = &mut self.decoder;
        let whole = if opcode == op::CHUNK {
            self.chunks.open(body, |opcode, body| decoder.take(opcode, body))
        } else {
            decoder.take(opcode, body)
        };
        if whole.is_none() {
            self.damaged.push((byte, body.len() as u64 + RECORD_HEAD));
        }
        let Some(samples) = &mut self.decoder.samples else { return Ok(()) };
        collect(samples, whole, table, &self.records.path, byte)
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
        let (lost_samples, last_s) =
            self.decoder.samples.as_ref().map_or((0, None), |samples| (samples.lost, samples.last_s));
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
                missing(&contents, last_s)
            },
        });
        warnings.extend(cut.iter().map(|cut| Warning::CutOff { missing: cut.missing.clone() }));
        EndOfRows {
            layout: Layout::Log(self.decoder.layout),
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
            let whole = match opcode {
                op::CHUNK => self.chunks.open(body, |opcode, body| match opcode {
                    op::MESSAGE => samples.message(body),
                    _ => Some(()),
                }),
                op::MESSAGE => samples.message(body),
                op::DATA_END => return Ok(false),
                _ => continue,
            };
            collect(samples, whole, table, &self.records.path, byte)?;
        }
        Ok(true)
    }
}

/// Moves what a record held into the table; nothing of it where it is damaged.
fn collect(
    samples: &mut SampleDecoder,
    whole: Option<()>,
    table: &mut Table,
    path: &Path,
    byte: u64,
) -> Result<()> {
    match whole {
        Some(()) => samples.hand_over(table),
        None => samples.discard(),
    }
    samples.check_order().map_err(|problem| RecordingError::Byte { path: path.into(), byte, problem })
}
