//! The recorder: takes samples without ever making the caller wait, and leaves a log that survives a crash.
//!
//! The caller's thread only encodes rows into a queue in memory. The writer's thread empties the queue twenty times a second,
//! closes a chunk and hands it to the system twice a second, and syncs to the disk every ten seconds. When the disk cannot
//! keep up for so long that the queue is full, samples are dropped, counted and reported.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::sample::{Event, SampleRow, Status, encode_event, encode_sample, encode_status};
use super::writer::{LogWriter, RecordingHeader, Topic};
use crate::error::{RecordingError, Result};

/// How often the queue is emptied.
const POLL: Duration = Duration::from_millis(50);

/// How old a chunk gets. The contract is one second; half of it leaves room for a busy machine.
const CHUNK_AGE: Duration = Duration::from_millis(500);

/// How often the file is synced to the disk.
const SYNC_EVERY: Duration = Duration::from_secs(10);

/// A running recording. Dropping it finishes the file as [`Recorder::finish`] does, but cannot report.
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

/// What a recording came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct RecordingSummary {
    /// Samples in the file.
    pub written: u64,
    /// Samples that are not in the file: `missed + overflowed + refused`.
    pub lost: u64,
    /// Of these: never arrived, by jumps of their sequence numbers.
    pub missed: u64,
    /// Of these: dropped because the disk did not keep up, or had failed.
    pub overflowed: u64,
    /// Of these: refused, because their time did not increase or their number of values was wrong.
    pub refused: u64,
    /// Length of the file, bytes.
    pub bytes: u64,
}

#[derive(Debug)]
struct Shared {
    queue: Mutex<Queue>,
}

/// Encoded messages waiting to be written.
#[derive(Debug, Default)]
struct Queue {
    bytes: Vec<u8>,
    messages: Vec<Waiting>,
    lost: u64,
    ended: bool,
    failed: bool,
}

#[derive(Debug, Clone, Copy)]
struct Waiting {
    topic: Topic,
    device_time_ns: i64,
    sequence: Option<u64>,
    end: usize,
}

impl Shared {
    /// The queue; it stays usable if the other thread panicked.
    fn queue(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Queue {
    fn push(&mut self, waiting: (Topic, i64, Option<u64>), encode: impl FnOnce(&mut Vec<u8>)) -> bool {
        if self.failed || self.bytes.len() >= Recorder::QUEUE_BYTES {
            return false;
        }
        encode(&mut self.bytes);
        let (topic, device_time_ns, sequence) = waiting;
        self.messages.push(Waiting { topic, device_time_ns, sequence, end: self.bytes.len() });
        true
    }
}

impl Recorder {
    /// Bytes of messages that may wait for the disk: half a minute of 10 kHz x 6 channels.
    pub const QUEUE_BYTES: usize = 32 << 20;

    /// Creates the file, writes everything known beforehand, and starts the writer's thread.
    ///
    /// # Errors
    /// When the file cannot be created or written; nothing is left behind then.
    pub fn create(path: &Path, header: &RecordingHeader) -> Result<Self> {
        let file = create_file(path, header.replace)?;
        let log = LogWriter::begin(path, file, header).inspect_err(|_| remove(path))?;
        let shared = Arc::new(Shared { queue: Mutex::new(Queue::default()) });
        let theirs = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("socam-recorder".into())
            .spawn(move || write_until_ended(log, &theirs))
            .map_err(|e| {
                remove(path);
                RecordingError::io(path, "record to", e)
            })?;
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

    /// Takes samples; never waits for the disk. Returns how many of them were taken; the others are counted as lost.
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

    /// Takes the board's state and counters; never waits. False when it was dropped.
    pub fn status(&mut self, status: &Status) -> bool {
        let waiting = (Topic::Status, status.device_time_ns, None);
        let encode = |out: &mut Vec<u8>| encode_status(status, out);
        self.shared.queue().push(waiting, encode)
    }

    /// Takes an event; never waits. False when it was dropped.
    pub fn event(&mut self, event: &Event) -> bool {
        let waiting = (Topic::Event, event.device_time_ns, None);
        let encode = |out: &mut Vec<u8>| encode_event(event, out);
        self.shared.queue().push(waiting, encode)
    }

    /// Samples lost so far, for whatever reason.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.counts.lost()
    }

    /// Bytes of messages that wait for the disk; samples are dropped when they reach [`Recorder::QUEUE_BYTES`].
    #[must_use]
    pub fn queued_bytes(&self) -> usize {
        self.shared.queue().bytes.len()
    }

    /// Whether half of the queue is still free. A source that can wait, as a simulation can, waits until it is.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.shared.queue().bytes.len() < Self::QUEUE_BYTES / 2
    }

    /// Whether writing has failed; [`Recorder::finish`] says why. What was written before can still be read.
    #[must_use]
    pub fn has_failed(&self) -> bool {
        self.shared.queue().failed
    }

    /// Writes what is waiting, the index and the summary, and syncs the file.
    ///
    /// # Errors
    /// When writing has failed at any time. A recording without one sample is removed, and said.
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
            remove(&self.path);
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

/// Empties the queue until the recording ends. Returns samples and bytes written.
fn write_until_ended(mut log: LogWriter, shared: &Shared) -> Result<(u64, u64)> {
    let mut batch = Queue::default();
    let mut chunk_opened = Instant::now();
    let mut synced = Instant::now();
    loop {
        batch.bytes.clear();
        batch.messages.clear();
        let (ended, lost) = {
            let mut queue = shared.queue();
            std::mem::swap(&mut queue.bytes, &mut batch.bytes);
            std::mem::swap(&mut queue.messages, &mut batch.messages);
            (queue.ended, queue.lost)
        };
        let written = write(&mut log, &batch).and_then(|()| {
            if chunk_opened.elapsed() >= CHUNK_AGE {
                chunk_opened = Instant::now();
                log.flush()?;
            }
            if synced.elapsed() >= SYNC_EVERY {
                synced = Instant::now();
                log.sync()?;
            }
            Ok(())
        });
        if let Err(e) = written {
            shared.queue().failed = true;
            return Err(e.after(log.samples_handed_over()));
        }
        if ended {
            let samples = log.samples();
            let handed_over = log.samples_handed_over();
            let bytes = log.finish(lost).map_err(|e| e.after(handed_over))?;
            return Ok((samples, bytes));
        }
        std::thread::park_timeout(POLL);
    }
}

fn write(log: &mut LogWriter, batch: &Queue) -> Result<()> {
    let mut start = 0;
    for message in &batch.messages {
        let bytes = &batch.bytes[start..message.end];
        log.message(message.topic, message.device_time_ns, message.sequence, bytes)?;
        start = message.end;
    }
    Ok(())
}

fn create_file(path: &Path, replace: bool) -> Result<File> {
    let mut options = OpenOptions::new();
    options.write(true);
    if replace {
        options.create(true).truncate(true);
    } else {
        options.create_new(true);
    }
    options.open(path).map_err(|e| RecordingError::io(path, "create", e))
}

/// Removes a file that holds nothing worth keeping; devices stay.
fn remove(path: &Path) {
    if path.metadata().is_ok_and(|metadata| metadata.is_file()) {
        let _ = std::fs::remove_file(path);
    }
}
