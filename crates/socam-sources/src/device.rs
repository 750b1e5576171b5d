//! What a source of samples is.

use socam_recording::Channel;

use crate::error::Result;

/// Bytes with the time in which they arrived.
#[derive(Debug, Clone, Copy)]
pub struct Chunk<'b> {
    /// The bytes.
    pub bytes: &'b [u8],
    /// The end of the read before, ns of the host's clock: no byte arrived earlier.
    pub from_ns: i64,
    /// The end of this read, ns of the host's clock: no byte arrived later.
    pub until_ns: i64,
}

impl Chunk<'_> {
    /// Time of arrival of the byte at an index, as if all of them had come evenly.
    #[must_use]
    pub fn arrival_ns(&self, index: usize) -> i64 {
        let share = (index + 1) as f64 / self.bytes.len().max(1) as f64;
        let span_ns = self.until_ns.saturating_sub(self.from_ns).max(0);
        self.from_ns.saturating_add((share * span_ns as f64) as i64).min(self.until_ns)
    }
}

/// Values of all channels that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The device's clock, s from any beginning.
    pub device_s: Option<f64>,
    /// The device's number of the row.
    pub number: Option<u64>,
    /// Time of arrival, ns of the host's clock.
    pub arrival_ns: i64,
    /// The time within which it arrived, or between question and answer, ns.
    pub spread_ns: i64,
    /// One value per channel in its SI unit, NaN where it is missing.
    pub values: Vec<f64>,
}

/// How rows that did not arrive are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Numbering {
    /// The device numbers its rows; the number begins anew after this many, or never (0).
    Numbered(u64),
    /// The device has a clock and samples evenly, or does not; that is found out.
    Clock,
    /// The device states neither, so what is lost without a trace is not noticed.
    Arrival,
}

/// What a device was heard to send.
#[derive(Debug, Clone, PartialEq)]
pub enum Heard {
    /// A row.
    Row(Row),
    /// Bytes in the place of a row that cannot be trusted, with the reason.
    Damaged(&'static str),
    /// Text that is no row, such as a greeting.
    Talk(String),
    /// A fault that the device reports, in words.
    Fault(String),
    /// The end of a run that commanded the device, which is at rest as far as it says.
    End {
        /// Why it ended before its profile.
        reason: Option<String>,
        /// Whether the operator ended it.
        by_operator: bool,
    },
}

/// A source of samples, as a protocol without input or output.
pub trait Device: Send {
    /// What it is, in words that follow "the device is".
    fn kind(&self) -> String;

    /// Its channels, in the order of every row's values.
    fn channels(&self) -> &[Channel];

    /// How rows that did not arrive are counted.
    fn numbering(&self) -> Numbering;

    /// Takes bytes that arrived.
    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>);

    /// Appends what is to be sent at this time, such as questions and heartbeats; returns the time of the next call, ns.
    ///
    /// # Errors
    /// When the device can no longer be used.
    fn poll(&mut self, _now_ns: i64, _out: &mut Vec<u8>) -> Result<Option<i64>> {
        Ok(None)
    }

    /// Whether anything is expected to arrive before the next call of [`Device::poll`].
    fn awaits(&self) -> bool {
        true
    }

    /// The link was interrupted: bytes of an unfinished message are dropped.
    fn interrupted(&mut self, heard: &mut Vec<Heard>);

    /// Begins to end a run that commands the device: by its profile's fade, or at once. Returns whether that takes until
    /// [`Heard::End`]; a device that is only listened to has nothing to end.
    fn end(&mut self, _now_ns: i64, _at_once: bool) -> bool {
        false
    }

    /// What must be sent to a device that moves before the link is left, whatever happened.
    fn last_words(&self) -> Option<Vec<u8>> {
        None
    }
}
