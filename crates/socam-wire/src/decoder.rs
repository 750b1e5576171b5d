//! Decodes messages from any stream of bytes.

use core::fmt;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::SCHEMA_VERSION;
use crate::encoder::{CHECKSUM, HEAD, MAX_FRAME, TAIL};

/// An error of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkError {
    /// Bytes that are no frame, or a damaged one.
    Corrupt {
        /// Number of bytes that were discarded.
        bytes: u32,
    },
    /// The peer speaks another version of the messages.
    ForeignVersion {
        /// Version that the peer speaks; ours is [`SCHEMA_VERSION`].
        theirs: u8,
    },
    /// Frames are missing before the next message.
    Lost {
        /// Number of missing frames.
        frames: u32,
    },
    /// The latest frame was repeated; it is ignored.
    Repeated {
        /// Number of the repeated frame.
        seq: u32,
    },
    /// A frame arrived after a later one (or again); it is ignored.
    Reordered {
        /// Number of the late frame.
        seq: u32,
        /// The expected number.
        expected: u32,
    },
    /// The peer counts frames from 0 again: it was restarted, and its earlier messages may be incomplete.
    Restarted,
    /// An intact frame of this version with an unknown message: same version, different program.
    Unreadable {
        /// Number of the frame.
        seq: u32,
    },
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Corrupt { bytes } => write!(f, "{bytes} bytes were no valid frame"),
            Self::ForeignVersion { theirs } => write!(
                f,
                "the other end speaks version {theirs} of the messages, this one speaks version {SCHEMA_VERSION}: \
                 bring firmware and host to the same release"
            ),
            Self::Lost { frames } => write!(f, "{frames} frames were lost"),
            Self::Repeated { seq } => write!(f, "frame {seq} came twice"),
            Self::Reordered { seq, expected } => write!(f, "frame {seq} came when frame {expected} was due"),
            Self::Restarted => f.write_str("the other end was restarted"),
            Self::Unreadable { seq } => {
                write!(f, "frame {seq} holds a message that this version does not know")
            }
        }
    }
}

impl core::error::Error for LinkError {}

/// Counts of each [`LinkError`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LinkCounts {
    /// Runs of bytes that were no frame.
    pub corrupt: u32,
    /// Frames of another version.
    pub foreign: u32,
    /// Missing frames.
    pub lost: u32,
    /// Frames that came twice.
    pub repeated: u32,
    /// Frames that came late.
    pub reordered: u32,
    /// Restarts of the peer.
    pub restarted: u32,
    /// Unknown messages.
    pub unreadable: u32,
}

impl LinkCounts {
    /// Adds one error.
    pub fn count(&mut self, error: &LinkError) {
        let (counter, by) = match *error {
            LinkError::Corrupt { .. } => (&mut self.corrupt, 1),
            LinkError::ForeignVersion { .. } => (&mut self.foreign, 1),
            LinkError::Lost { frames } => (&mut self.lost, frames),
            LinkError::Repeated { .. } => (&mut self.repeated, 1),
            LinkError::Reordered { .. } => (&mut self.reordered, 1),
            LinkError::Restarted => (&mut self.restarted, 1),
            LinkError::Unreadable { .. } => (&mut self.unreadable, 1),
        };
        *counter = counter.saturating_add(by);
    }

    /// The total.
    pub fn total(&self) -> u32 {
        [
            self.corrupt,
            self.foreign,
            self.lost,
            self.repeated,
            self.reordered,
            self.restarted,
            self.unreadable,
        ]
        .into_iter()
        .fold(0, u32::saturating_add)
    }
}

/// Number of consecutive old frames that mean a restart; fewer may be stray frames.
const RESTART_AFTER: u32 = 4;

/// The receiving end of a link. After any invalid bytes the next whole frame is decoded.
#[derive(Debug, Clone)]
pub struct Decoder<M> {
    buffer: [u8; MAX_FRAME],
    /// Number of bytes since the latest zero; more than `buffer` holds are no frame.
    len: usize,
    /// Expected number of the next frame; `None` until the first one.
    expected: Option<u32>,
    /// Number of the latest old frame, and how many were consecutive.
    old: (u32, u32),
    /// A decoded message that waits until an error before it has been returned.
    waiting: Option<Result<M, LinkError>>,
}

impl<M: DeserializeOwned> Default for Decoder<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: DeserializeOwned> Decoder<M> {
    /// A decoder without any bytes.
    pub fn new() -> Self {
        Self { buffer: [0; MAX_FRAME], len: 0, expected: None, old: (0, 0), waiting: None }
    }

    /// The next message or error in `bytes`, which is advanced past the bytes used; `None` when all are used.
    ///
    /// ```
    /// # use socam_wire::{Decoder, Encoder, ToBoard};
    /// let mut frame = [0; socam_wire::MAX_FRAME];
    /// let len = Encoder::new().encode(&ToBoard::Hello, &mut frame)?;
    /// let mut decoder = Decoder::<ToBoard>::new();
    /// let mut bytes = &frame[..len];
    /// while let Some(item) = decoder.next(&mut bytes) {
    ///     assert_eq!(item, Ok(ToBoard::Hello));
    /// }
    /// # Ok::<(), socam_wire::BufferTooSmall>(())
    /// ```
    pub fn next(&mut self, bytes: &mut &[u8]) -> Option<Result<M, LinkError>> {
        if let Some(item) = self.waiting.take() {
            return Some(item);
        }
        while let Some((&byte, rest)) = bytes.split_first() {
            *bytes = rest;
            if byte != 0 {
                if let Some(place) = self.buffer.get_mut(self.len) {
                    *place = byte;
                }
                self.len = self.len.saturating_add(1);
            } else if self.len > 0 {
                let item = self.frame();
                self.len = 0;
                return Some(item);
            }
        }
        None
    }

    /// Decodes the bytes between two zeros.
    fn frame(&mut self) -> Result<M, LinkError> {
        let corrupt = LinkError::Corrupt { bytes: u32::try_from(self.len).unwrap_or(u32::MAX) };
        let encoded = self.buffer.get_mut(..self.len).ok_or(corrupt)?;
        let len = cobs::decode_in_place(encoded).map_err(|_| corrupt)?;
        let raw = encoded.get(..len).ok_or(corrupt)?;

        // The version first: the rest may differ in other versions.
        let [version, complement, ..] = *raw else {
            return Err(corrupt);
        };
        if version != !complement {
            return Err(corrupt);
        }
        if version != SCHEMA_VERSION {
            return Err(LinkError::ForeignVersion { theirs: version });
        }

        let (sealed, checksum) = raw.split_last_chunk::<TAIL>().ok_or(corrupt)?;
        if CHECKSUM.checksum(sealed) != u32::from_le_bytes(*checksum) {
            return Err(corrupt);
        }
        let (&[_, _, s0, s1, s2, s3], payload) = sealed.split_first_chunk::<HEAD>().ok_or(corrupt)?;
        let seq = u32::from_le_bytes([s0, s1, s2, s3]);
        let message = match postcard::take_from_bytes::<M>(payload) {
            Ok((message, [])) => Ok(message),
            _ => Err(LinkError::Unreadable { seq }),
        };
        self.place(seq, message)
    }

    /// Checks the number of an intact frame.
    fn place(&mut self, seq: u32, message: Result<M, LinkError>) -> Result<M, LinkError> {
        let expected = self.expected.unwrap_or(seq);
        let ahead = seq.wrapping_sub(expected);
        if ahead == 0 {
            self.accept(seq);
            return message;
        }
        if ahead < 1 << 31 {
            self.accept(seq);
            self.waiting = Some(message);
            return Err(LinkError::Lost { frames: ahead });
        }
        if ahead == u32::MAX {
            return Err(LinkError::Repeated { seq });
        }
        let (last, run) = self.old;
        let run = if run > 0 && seq == last.wrapping_add(1) { run + 1 } else { 1 };
        self.old = (seq, run);
        if seq == 0 || run >= RESTART_AFTER {
            self.accept(seq);
            self.waiting = Some(message);
            return Err(LinkError::Restarted);
        }
        Err(LinkError::Reordered { seq, expected })
    }

    fn accept(&mut self, seq: u32) {
        self.expected = Some(seq.wrapping_add(1));
        self.old = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All patterns of losses among eight frames, from all numbers at which they pass the wrap.
    #[test]
    fn lost_frames_are_counted_across_the_wrap_of_their_numbers() {
        const FRAMES: u32 = if cfg!(miri) { 3 } else { 8 };
        for first in (0..=FRAMES).map(|back| 0u32.wrapping_sub(back)) {
            for arrives in 0..1u32 << FRAMES {
                let mut decoder = Decoder::<u32>::default();
                let mut counts = LinkCounts::default();
                let all = (0..FRAMES).filter(|frame| arrives >> frame & 1 == 1);
                for frame in all.clone() {
                    let seq = first.wrapping_add(frame);
                    if let Err(error) = decoder.place(seq, Ok(frame)) {
                        counts.count(&error);
                        assert_eq!(decoder.waiting.take(), Some(Ok(frame)), "the message itself is kept");
                    }
                    assert_eq!(decoder.place(seq, Ok(frame)), Err(LinkError::Repeated { seq }));
                }
                let between =
                    all.clone().max().zip(all.clone().min()).map_or(0, |(last, first)| last - first + 1);
                let lost = between - all.count() as u32;
                assert_eq!(counts, LinkCounts { lost, ..LinkCounts::default() }, "{first}: {arrives:b}");
            }
        }
    }
}
