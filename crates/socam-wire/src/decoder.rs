//! Bytes to messages, whatever the bytes.

use core::fmt;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::SCHEMA_VERSION;
use crate::encoder::{CHECKSUM, HEAD, MAX_FRAME, TAIL};

/// What went wrong on a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkError {
    /// Bytes that are no frame, or a damaged one.
    Corrupt {
        /// How many.
        bytes: u32,
    },
    /// The peer speaks another version of the messages.
    ForeignVersion {
        /// Its version; ours is [`SCHEMA_VERSION`].
        theirs: u8,
    },
    /// Frames are missing before the next message.
    Lost {
        /// How many.
        frames: u32,
    },
    /// The latest frame came again; it was left out.
    Repeated {
        /// Its number.
        seq: u32,
    },
    /// A frame came after a later one (or came again); it was left out.
    Reordered {
        /// Its number.
        seq: u32,
        /// The number that was due.
        expected: u32,
    },
    /// The peer began to count anew: it was restarted. What it sent before may be incomplete.
    Restarted,
    /// A sound frame of our version with a message that we do not know: same version, different program.
    Unreadable {
        /// Its number.
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

/// How often each [`LinkError`] happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LinkCounts {
    /// Stretches of bytes that were no frame.
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
    /// Messages that are not known.
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

    /// All of them together.
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

/// Old numbers in direct succession that prove a restart. A stray old frame or two must not reset the count.
const RESTART_AFTER: u32 = 4;

/// One direction of a link, at its receiving end. Any stream of bytes is survived: after garbage the next whole frame is
/// understood.
#[derive(Debug, Clone)]
pub struct Decoder<M> {
    buffer: [u8; MAX_FRAME],
    /// Bytes since the latest zero; more than `buffer` holds cannot become a frame.
    len: usize,
    /// The number that is due; `None` until the first frame: a receiver may join late.
    expected: Option<u32>,
    /// The latest frame with an old number, and how many came in succession.
    old: (u32, u32),
    /// What a frame held, while what happened before it is told first.
    waiting: Option<Result<M, LinkError>>,
}

impl<M: DeserializeOwned> Default for Decoder<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: DeserializeOwned> Decoder<M> {
    /// Ready for the first byte.
    pub fn new() -> Self {
        Self { buffer: [0; MAX_FRAME], len: 0, expected: None, old: (0, 0), waiting: None }
    }

    /// The next message or mishap in `bytes`, which is advanced past what was used; `None` when all of it is used up.
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

    /// Judges the bytes between two zeros.
    fn frame(&mut self) -> Result<M, LinkError> {
        let corrupt = LinkError::Corrupt { bytes: u32::try_from(self.len).unwrap_or(u32::MAX) };
        let encoded = self.buffer.get_mut(..self.len).ok_or(corrupt)?;
        let len = cobs::decode_in_place(encoded).map_err(|_| corrupt)?;
        let raw = encoded.get(..len).ok_or(corrupt)?;

        // The version first: all else may look different in another one.
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

    /// Judges a sound frame by its number.
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
