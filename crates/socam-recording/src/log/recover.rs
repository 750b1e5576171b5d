//! Copies what is whole of a damaged or cut log into a new one, with a new index.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::Path;

use mcap::records::{MessageHeader, Metadata, Record, op};
use mcap::{McapError, Writer};

use super::names::{RECOVERED_NAME, SAMPLE_TOPIC, SUMMARY_NAME};
use super::records::{ChunkOpener, Next, Records};
use super::schema;
use super::sink::LogSink;
use super::writer::{failure, options};
use crate::error::{RecordingError, Result};
use crate::output_file::OutputFile;
use crate::{Dataset, Selection, Warning};

/// Result of a recovery.
#[derive(Debug, Clone, PartialEq)]
pub struct Recovered {
    /// Samples in the new log.
    pub samples: u64,
    /// Samples that are known to be missing.
    pub lost: u64,
    /// Warnings about damaged or missing parts.
    pub missing: Vec<Warning>,
}

/// Writes a new log at `target` that holds all that can be read of `source`: samples, statuses and events bit for bit, attachments and
/// metadata, and a note of what is missing.
///
/// # Errors
/// When no sample can be read, or the target cannot be written; no file is left then.
pub fn recover(source: &Path, target: &Path) -> Result<Recovered> {
    let data = Dataset::open_selection(&Selection::whole(source))?;
    let recovered =
        Recovered { samples: data.rows(), lost: data.lost_samples(), missing: data.warnings().to_vec() };
    let mut output = OutputFile::create(target)?;
    let writer = options().create(LogSink::new(output.handle()?));
    let mut copy = Copy {
        writer: writer.map_err(|e| failure(target, "create", e))?,
        target,
        schemas: BTreeMap::new(),
        channels: BTreeMap::new(),
        written: BTreeSet::new(),
        samples: 0,
    };
    for (opcode, body) in super::summary::topics(source)? {
        copy.record(opcode, &body)?;
    }
    copy.records_of(source)?;
    if copy.samples != recovered.samples {
        return Err(RecordingError::NotCopied {
            path: source.into(),
            copied: copy.samples,
            samples: recovered.samples,
        });
    }
    copy.finish(source, &recovered)?;
    output.flush().map_err(|e| RecordingError::io(target, "write to", e))?;
    output.commit()?;
    Ok(recovered)
}

/// A log being copied.
struct Copy<'t> {
    writer: Writer<LogSink>,
    target: &'t Path,
    /// Name, encoding and data of each schema, by its number.
    schemas: BTreeMap<u16, (String, String, Vec<u8>)>,
    channels: BTreeMap<u16, mcap::records::Channel>,
    /// Numbers of the channels in the new log.
    written: BTreeSet<u16>,
    /// Samples in the new log.
    samples: u64,
}

impl Copy<'_> {
    /// Copies all whole records up to the end of the data.
    fn records_of(&mut self, source: &Path) -> Result<()> {
        let mut records = Records::open(source)?;
        let mut chunks = ChunkOpener::new();
        loop {
            let (opcode, body) = match records.next(|opcode| opcode != op::MESSAGE_INDEX)? {
                Next::Record { opcode: op::DATA_END, .. } | Next::End | Next::Cut(_) => return Ok(()),
                Next::Record { opcode, body, .. } => (opcode, body),
                Next::Damaged(..) => continue,
            };
            if opcode != op::CHUNK {
                self.record(opcode, body)?;
                continue;
            }
            let mut inside: Vec<(u8, Vec<u8>)> = Vec::new();
            let whole = chunks.open(body, |opcode, body| {
                inside.push((opcode, body.to_vec()));
                Some(())
            });
            // Schemas and channels of a damaged chunk are used, since there may be no other source for them.
            inside.retain(|(opcode, _)| whole.is_some() || matches!(*opcode, op::SCHEMA | op::CHANNEL));
            inside.iter().try_for_each(|(opcode, body)| self.record(*opcode, body))?;
            if whole.is_some() {
                self.writer.flush().map_err(|e| failure(self.target, "write to", e))?;
            }
        }
    }

    /// Copies a record; one that cannot be decoded is left out.
    fn record(&mut self, opcode: u8, body: &[u8]) -> Result<()> {
        let copied = match super::parse::record(opcode, body) {
            Some(Record::Schema { header, data }) => {
                if !self.is_of_samples(header.id) {
                    self.schemas.insert(header.id, (header.name, header.encoding, data.into_owned()));
                }
                Ok(())
            }
            Some(Record::Channel(channel)) => {
                // Without checksums one copy of several may be damaged: one that can be read is kept.
                let known = self.channels.get(&channel.id);
                let is_known = known
                    .is_some_and(|known| known.topic == SAMPLE_TOPIC && self.is_of_samples(known.schema_id));
                if !is_known {
                    self.channels.insert(channel.id, channel);
                }
                Ok(())
            }
            Some(Record::Message { header, data }) => self.message(&header, &data),
            Some(Record::Metadata(metadata)) if metadata.name != SUMMARY_NAME => {
                self.writer.write_metadata(&metadata)
            }
            Some(Record::Attachment { header, data, .. }) => self.writer.attach(&mcap::Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            }),
            _ => Ok(()),
        };
        copied.map_err(|e| failure(self.target, "write to", e))
    }

    /// Whether a schema is known that describes samples.
    fn is_of_samples(&self, schema: u16) -> bool {
        let known = self.schemas.get(&schema);
        known.is_some_and(|(name, _, data)| {
            name == schema::SAMPLE && schema::double_fields(data, name).is_some()
        })
    }

    fn message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), McapError> {
        if !self.written.contains(&header.channel_id) {
            let Some(channel) = self.channels.get(&header.channel_id) else { return Ok(()) };
            match self.schemas.get(&channel.schema_id) {
                Some((name, encoding, data)) => {
                    self.writer.add_schema_with_id(channel.schema_id, name, encoding, data)?;
                }
                None if channel.schema_id != 0 => return Ok(()),
                None => {}
            }
            self.writer.add_channel_with_id(
                channel.id,
                channel.schema_id,
                &channel.topic,
                &channel.message_encoding,
                &channel.metadata,
            )?;
            self.written.insert(channel.id);
        }
        let channel = self.channels.get(&header.channel_id);
        self.samples += u64::from(channel.is_some_and(|channel| channel.topic == SAMPLE_TOPIC));
        self.writer.write_to_known_channel(header, data)
    }

    /// Writes counts, the note of what is missing, and the index.
    fn finish(mut self, source: &Path, recovered: &Recovered) -> Result<()> {
        let texts = |entries: [(&str, String); 2]| entries.map(|(name, text)| (name.to_owned(), text)).into();
        let missing: Vec<String> = recovered.missing.iter().map(ToString::to_string).collect();
        let note = [("source", source.display().to_string()), ("missing", missing.join("; "))];
        let counts = [
            ("samples_written", recovered.samples.to_string()),
            ("samples_lost", recovered.lost.to_string()),
        ];
        [(RECOVERED_NAME, note), (SUMMARY_NAME, counts)]
            .into_iter()
            .try_for_each(|(name, entries)| {
                self.writer.write_metadata(&Metadata { name: name.into(), metadata: texts(entries) })
            })
            .and_then(|()| self.writer.finish())
            .map_err(|e| failure(self.target, "write to", e))?;
        self.writer.into_inner().flush().map_err(|e| RecordingError::io(self.target, "write to", e))
    }
}
