//! The recorder: accepts samples without blocking the caller, and writes a log that survives a crash.
//!
//! The caller's thread only encodes rows into a queue in memory. The writer's thread empties the queue twenty times a second,
//! closes and flushes a chunk twice a second, and syncs to the disk every ten seconds. When the disk is too slow and the queue
//! is full, samples are dropped, counted and reported.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;

use super::file::LogFile;
use super::queue::{self, Shared, write_until_ended};
use super::sample::{Event, SampleRow, Status, encode_event, encode_sample, encode_status};
use super::writer::{LogWriter, RecordingHeader, Topic};
use super::writing::Writing;
use crate::error::{RecordingError, Result};

/// A running recording. Dropping it finishes the file as [`Recorder::finish`] does, but cannot report.
///
/// ```
/// use socam_recording::{Channel, Dataset, Event, Recorder, RecordingHeader, SampleRow, Status, Unit};
///
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("run.mcap");
/// let header = RecordingHeader::new(vec![Channel::new("torque", Unit::Nm)]);
/// let mut recorder = Recorder::create(&path, &header)?;
/// for sequence in [0, 1, 3] {
///     let device_time_ns = 1_000_000 * sequence as i64;
///     let row = SampleRow { device_time_ns, sequence, flags: 0, raw_counts: &[], values: &[0.5] };
///     assert_eq!(recorder.push_samples(&[row]), 1);
/// }
/// assert!(recorder.event(&Event { device_time_ns: 3_000_000, kind: "note".into(), text: "warm".into() }));
/// let status = Status { device_time_ns: 3_000_000, state: "running".into(), overruns: 0, lost: 1, link_errors: 0 };
/// assert!(recorder.status(&status));
/// // The sequence number 2 never arrived.
/// assert!(recorder.lost() == 1 && recorder.has_room() && !recorder.has_failed());
/// let summary = recorder.finish()?;
/// assert_eq!((summary.written, summary.missed), (3, 1));
/// let data = Dataset::open(path.to_str().unwrap())?;
/// assert_eq!((data.rows(), data.lost_samples()), (3, 1));
/// assert!(data.contents().expect("a log").events.iter().any(|event| event.text == "warm"));
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
#[derive(Debug)]
pub struct Recorder {
    path: PathBuf,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<Result<(u64, u64)>>>,
    channels: usize,
    expected_sequence: Option<u64>,
    latest_device_ns: Option<i64>,
    counts: Counts,
}

#[derive(Debug, Default, Clone, Copy)]
struct Counts {
    missed: u64,
    overflowed: u64,
    refused: u64,
}

/// Counts of a finished recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct RecordingSummary {
    /// Samples in the file.
    pub written: u64,
    /// Samples that are not in the file: `missed + overflowed + refused`.
    pub lost: u64,
    /// Lost samples that never arrived, counted by jumps of their sequence numbers.
    pub missed: u64,
    /// Lost samples that were dropped because the disk was too slow or had failed.
    pub overflowed: u64,
    /// Lost samples that were refused because their time did not increase or their number of values was wrong.
    pub refused: u64,
    /// Length of the file, bytes.
    pub bytes: u64,
}

impl Recorder {
    /// Bytes of messages that may wait for the disk: half a minute of 10 kHz x 6 channels.
    pub const QUEUE_BYTES: usize = queue::QUEUE_BYTES;

    /// Creates the file, writes and syncs everything known beforehand, and starts the writer's thread. A file that is replaced is there
    /// until the first samples of the new one are synced, which lies beside it as `NAME.XXXXXX.part` till then.
    ///
    /// # Errors
    /// When the file cannot be created or written; no file is left then.
    pub fn create(path: &Path, header: &RecordingHeader) -> Result<Self> {
        let (file, output) = LogFile::create(path, header.replace)?;
        let log = Writing::begin(LogWriter::begin(path, output, header)?, file)?;
        let shared = Arc::new(Shared::default());
        let theirs = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("socam-recorder".into())
            .spawn(move || write_until_ended(log, &theirs))
            .map_err(|e| RecordingError::io(path, "record to", e))?;
        Ok(Self {
            path: path.into(),
            shared,
            thread: Some(thread),
            channels: header.channels.len(),
            expected_sequence: None,
            latest_device_ns: None,
            counts: Counts::default(),
        })
    }

    /// Queues samples without waiting for the disk. Returns the number accepted; the others are counted as lost.
    pub fn push_samples(&mut self, rows: &[SampleRow<'_>]) -> usize {
        let mut queue = self.shared.queue();
        let mut taken = 0;
        for row in rows {
            if row.values.len() != self.channels
                || self.latest_device_ns.is_some_and(|t| row.device_time_ns <= t)
            {
                self.counts.refused += 1;
                continue;
            }
            self.latest_device_ns = Some(row.device_time_ns);
            if let Some(expected) = self.expected_sequence {
                self.counts.missed += row.sequence.saturating_sub(expected);
            }
            self.expected_sequence = Some(row.sequence.saturating_add(1));
            let waiting = (Topic::Sample, row.device_time_ns, Some(row.sequence));
            if queue.push(waiting, |out| encode_sample(row, None, out)) {
                taken += 1;
            } else {
                self.counts.overflowed += 1;
            }
        }
        queue.lost = self.counts.lost();
        taken
    }

    /// Queues the board's state and counters without waiting. False when they were dropped.
    pub fn status(&mut self, status: &Status) -> bool {
        let waiting = (Topic::Status, status.device_time_ns, None);
        let encode = |out: &mut Vec<u8>| encode_status(status, out);
        self.shared.queue().push(waiting, encode)
    }

    /// Queues an event without waiting. False when it was dropped.
    pub fn event(&mut self, event: &Event) -> bool {
        let waiting = (Topic::Event, event.device_time_ns, None);
        let encode = |out: &mut Vec<u8>| encode_event(event, out);
        self.shared.queue().push(waiting, encode)
    }

    /// Number of samples lost so far, for any reason.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.counts.lost()
    }

    /// Bytes of messages that wait for the disk; samples are dropped when they reach [`Recorder::QUEUE_BYTES`].
    #[must_use]
    pub fn queued_bytes(&self) -> usize {
        self.shared.queue().bytes.len()
    }

    /// Whether half of the queue is free. A source that can wait, such as a simulation, waits until it is.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.shared.queue().bytes.len() < Self::QUEUE_BYTES / 2
    }

    /// Whether writing has failed; [`Recorder::finish`] says why. What was written before can still be read.
    #[must_use]
    pub fn has_failed(&self) -> bool {
        self.shared.queue().failed
    }

    /// Writes the queue, the index and the summary, and syncs the file.
    ///
    /// # Errors
    /// When writing or syncing has failed at any time. A recording without a sample is removed, which is an error.
    pub fn finish(mut self) -> Result<RecordingSummary> {
        let (written, bytes) = self.stop()?;
        let Counts { missed, overflowed, refused } = self.counts;
        Ok(RecordingSummary { written, lost: self.counts.lost(), missed, overflowed, refused, bytes })
    }

    fn stop(&mut self) -> Result<(u64, u64)> {
        let Some(thread) = self.thread.take() else {
            return Ok((0, 0));
        };
        self.shared.queue().ended = true;
        thread.thread().unpark();
        let (written, bytes) = thread.join().map_err(|_| {
            RecordingError::io(&self.path, "record to", std::io::Error::other("the writer stopped"))
        })??;
        if written == 0 {
            return Err(RecordingError::NothingRecorded { path: self.path.clone() });
        }
        Ok((written, bytes))
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        let _ = self.stop();
    }
}

impl Counts {
    fn lost(&self) -> u64 {
        self.missed + self.overflowed + self.refused
    }
}
