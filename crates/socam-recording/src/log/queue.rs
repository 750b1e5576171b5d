//! The recorder's queue in memory, and the thread that writes it to the log.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::writer::Topic;
use super::writing::Writing;
use crate::error::Result;

/// Bytes of messages that may wait for the disk: half a minute of 10 kHz x 6 channels.
pub(super) const QUEUE_BYTES: usize = 32 << 20;

/// Interval at which the queue is emptied.
const POLL: Duration = Duration::from_millis(50);

/// Longest time before a chunk is closed. The contract is one second; half of it leaves room for a busy machine.
const CHUNK_AGE: Duration = Duration::from_millis(500);

/// Interval of syncs to the disk.
const SYNC_EVERY: Duration = Duration::from_secs(10);

/// The queue between the caller's thread and the writer's.
#[derive(Debug, Default)]
pub(super) struct Shared {
    queue: Mutex<Queue>,
}

/// Encoded messages waiting to be written.
#[derive(Debug, Default)]
pub(super) struct Queue {
    pub(super) bytes: Vec<u8>,
    messages: Vec<Waiting>,
    pub(super) lost: u64,
    pub(super) ended: bool,
    pub(super) failed: bool,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Waiting {
    topic: Topic,
    device_time_ns: i64,
    sequence: Option<u64>,
    end: usize,
}

impl Shared {
    /// The queue; it stays usable if the other thread panicked.
    pub(super) fn queue(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Queue {
    /// Encodes a message into the queue; false when the queue is full or writing has failed.
    pub(super) fn push(
        &mut self,
        waiting: (Topic, i64, Option<u64>),
        encode: impl FnOnce(&mut Vec<u8>),
    ) -> bool {
        if self.failed || self.bytes.len() >= QUEUE_BYTES {
            return false;
        }
        encode(&mut self.bytes);
        let (topic, device_time_ns, sequence) = waiting;
        self.messages.push(Waiting { topic, device_time_ns, sequence, end: self.bytes.len() });
        true
    }
}

/// Empties the queue until the recording ends. Returns samples and bytes written.
pub(super) fn write_until_ended(mut log: Writing, shared: &Shared) -> Result<(u64, u64)> {
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
                log.close_chunk()?;
            }
            if synced.elapsed() >= SYNC_EVERY {
                synced = Instant::now();
                log.sync()?;
            }
            Ok(())
        });
        if let Err(e) = written {
            shared.queue().failed = true;
            return Err(e.after(log.samples_flushed()));
        }
        if ended {
            return log.finish(lost);
        }
        std::thread::park_timeout(POLL);
    }
}

fn write(log: &mut Writing, batch: &Queue) -> Result<()> {
    let mut start = 0;
    for message in &batch.messages {
        let bytes = &batch.bytes[start..message.end];
        log.message(message.topic, message.device_time_ns, message.sequence, bytes)?;
        start = message.end;
    }
    Ok(())
}
