//! Writes a log's records in order; shared by the recorder's thread and the converters.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions, Writer};

use super::attachments::Attachment;
use super::names::{EVENT_TOPIC, METADATA_NAME, PROFILE, SAMPLE_TOPIC, STATUS_TOPIC, SUMMARY_NAME};
use super::sample::{Event, encode_event};
use super::schema;
use super::sink::LogSink;
use crate::Channel;
use crate::error::{RecordingError, Result};

/// Uncompressed bytes at which a chunk is closed before the interval of flushes ends.
const CHUNK_BYTES: u64 = 1 << 20;

/// Facts about a recording that are known before its first sample.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingHeader {
    /// Channels, in the order of every row's values.
    pub channels: Vec<Channel>,
    /// Time of the day at device time 0, ns since 1970 (UTC).
    pub start_unix_ns: u64,
    /// Board, firmware and host versions, operator's notes and other texts, by name.
    pub metadata: BTreeMap<String, String>,
    /// Calibration, model, profile.
    pub attachments: Vec<Attachment>,
    /// Planned duration, s, from which a reader computes how much of a cut recording is missing.
    pub planned_duration_s: Option<f64>,
    /// Whether a file of this name is replaced; otherwise it is an error.
    pub replace: bool,
}

impl RecordingHeader {
    /// A header with channels and nothing else; starts at 1970.
    #[must_use]
    pub fn new(channels: Vec<Channel>) -> Self {
        Self {
            channels,
            start_unix_ns: 0,
            metadata: BTreeMap::new(),
            attachments: Vec::new(),
            planned_duration_s: None,
            replace: false,
        }
    }
}

/// The topic a message belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Topic {
    Sample,
    Status,
    Event,
}

pub(crate) struct LogWriter {
    path: PathBuf,
    writer: Writer<LogSink>,
    handle: File,
    ids: [u16; 3],
    sequences: [u32; 3],
    start_unix_ns: u64,
    latest_ns: u64,
    messages: [u64; 3],
    samples_flushed: u64,
}

impl LogWriter {
    /// Writes everything known beforehand and flushes it to the operating system, so that it survives a crash of this process.
    pub(crate) fn begin(path: &Path, file: File, header: &RecordingHeader) -> Result<Self> {
        let sink = LogSink::new(file);
        let begin = || -> Result<Self, McapError> {
            let handle = sink.handle()?;
            let mut writer = options().create(sink)?;
            writer.write_metadata(&metadata(header))?;
            for attachment in &header.attachments {
                writer.attach(&mcap::Attachment {
                    log_time: header.start_unix_ns,
                    create_time: header.start_unix_ns,
                    name: attachment.name.clone(),
                    media_type: attachment.media_type.clone(),
                    data: attachment.data.as_slice().into(),
                })?;
            }
            let ids = topics(&mut writer, &header.channels)?;
            Ok(Self {
                path: path.into(),
                writer,
                handle,
                ids,
                sequences: [0; 3],
                start_unix_ns: header.start_unix_ns,
                latest_ns: 0,
                messages: [0; 3],
                samples_flushed: 0,
            })
        };
        let mut log = begin().map_err(|e| failure(path, "create", e))?;
        let start = Event { device_time_ns: 0, kind: "start".into(), text: "recording started".into() };
        let mut bytes = Vec::new();
        encode_event(&start, &mut bytes);
        log.message(Topic::Event, 0, None, &bytes)?;
        log.flush()?;
        Ok(log)
    }

    /// Writes one message. Log times never decrease: a late status or event is logged at the latest time and keeps its own time
    /// in its content.
    pub(crate) fn message(
        &mut self,
        topic: Topic,
        device_time_ns: i64,
        sequence: Option<u64>,
        bytes: &[u8],
    ) -> Result<()> {
        let time_ns = self.start_unix_ns.saturating_add_signed(device_time_ns);
        self.latest_ns = self.latest_ns.max(time_ns);
        let index = topic as usize;
        let counted = self.sequences[index];
        self.sequences[index] = counted.wrapping_add(1);
        let header = MessageHeader {
            channel_id: self.ids[index],
            sequence: sequence.map_or(counted, |sequence| sequence as u32),
            log_time: self.latest_ns,
            publish_time: self.latest_ns,
        };
        self.messages[index] += 1;
        self.writer.write_to_known_channel(&header, bytes).map_err(|e| failure(&self.path, "write to", e))
    }

    /// Closes the chunk and flushes it to the operating system.
    pub(crate) fn flush(&mut self) -> Result<()> {
        self.writer.flush().map_err(|e| failure(&self.path, "write to", e))?;
        self.samples_flushed = self.samples();
        Ok(())
    }

    /// The file, for syncing it.
    pub(super) fn file(&self) -> &File {
        &self.handle
    }

    /// Number of samples flushed to the operating system.
    pub(crate) fn samples_flushed(&self) -> u64 {
        self.samples_flushed
    }

    /// Samples written so far.
    pub(crate) fn samples(&self) -> u64 {
        self.messages[Topic::Sample as usize]
    }

    /// Writes the summary and index. Returns the file, which is not synced yet, and its length in bytes.
    pub(crate) fn finish(mut self, lost: u64) -> Result<(File, u64)> {
        let summary = Metadata {
            name: SUMMARY_NAME.into(),
            metadata: BTreeMap::from([
                ("samples_written".into(), self.samples().to_string()),
                ("samples_lost".into(), lost.to_string()),
            ]),
        };
        self.writer
            .write_metadata(&summary)
            .and_then(|()| self.writer.finish())
            .map_err(|e| failure(&self.path, "write to", e))?;
        let mut sink = self.writer.into_inner();
        std::io::Write::flush(&mut sink).map_err(|e| RecordingError::io(&self.path, "write to", e))?;
        Ok((self.handle, sink.written()))
    }
}

pub(super) fn options() -> WriteOptions {
    // A chunk is assembled in memory and written at once: the file never holds a partial chunk header.
    let options = WriteOptions::new()
        .profile(PROFILE)
        .library(concat!("socam ", env!("CARGO_PKG_VERSION")))
        .chunk_size(Some(CHUNK_BYTES))
        .disable_seeking(true);
    // The compressor is in C.
    #[cfg(target_arch = "wasm32")]
    return options.compression(None);
    #[cfg(not(target_arch = "wasm32"))]
    options.compression(Some(mcap::Compression::Zstd)).compression_level(1).compression_threads(0)
}

fn metadata(header: &RecordingHeader) -> Metadata {
    let mut metadata = header.metadata.clone();
    metadata.insert("start_unix_ns".into(), header.start_unix_ns.to_string());
    if let Some(duration_s) = header.planned_duration_s {
        metadata.insert("planned_duration_s".into(), duration_s.to_string());
    }
    Metadata { name: METADATA_NAME.into(), metadata }
}

fn topics(writer: &mut Writer<LogSink>, channels: &[Channel]) -> Result<[u16; 3], McapError> {
    let columns: Vec<String> = channels.iter().map(Channel::column_name).collect();
    let columns = BTreeMap::from([("columns".to_owned(), serde_json::Value::from(columns).to_string())]);
    let mut add = |name, data: Vec<u8>, topic, metadata: &BTreeMap<_, _>| {
        let id = writer.add_schema(name, "protobuf", &data)?;
        writer.add_channel(id, topic, "protobuf", metadata)
    };
    Ok([
        add(schema::SAMPLE, schema::sample(channels), SAMPLE_TOPIC, &columns)?,
        add(schema::STATUS, schema::status(), STATUS_TOPIC, &BTreeMap::new())?,
        add(schema::EVENT, schema::event(), EVENT_TOPIC, &BTreeMap::new())?,
    ])
}

pub(crate) fn failure(path: &Path, action: &'static str, error: McapError) -> RecordingError {
    let source = match error {
        McapError::Io(source) => source,
        other => io::Error::other(other),
    };
    RecordingError::io(path, action, source)
}
