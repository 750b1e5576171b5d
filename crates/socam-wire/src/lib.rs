//! What board and host say to each other, and how it is framed.
//!
//! A frame is `0x00 | COBS(version, !version, seq, payload, crc) | 0x00`: the payload is a [`ToBoard`] or [`ToHost`] in
//! postcard's encoding, `seq` counts the sender's frames, `crc` is a CRC-32 over everything before it (numbers little
//! endian). The two version bytes vouch for each other, so a peer of another [`SCHEMA_VERSION`] is recognised whatever the
//! rest of its frames looks like. The zero on both sides lets a frame survive any garbage before it.
//!
//! [`Encoder`] and [`Decoder`] neither read nor write anything themselves: the caller brings the bytes. [`BoardLink`] is the
//! board's end of the conversation, the same on the board and in the virtual board.
#![no_std]
#![cfg_attr(
    not(test),
    deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unwrap_used)
)]

#[cfg(test)]
extern crate std;

mod batch;
mod decoder;
mod encoder;
mod link;
mod message;
mod text;

pub use batch::{BATCH_SAMPLES, SampleBatch};
pub use decoder::{Decoder, LinkCounts, LinkError};
pub use encoder::{BufferTooSmall, Encoder, MAX_FRAME};
pub use link::BoardLink;
pub use message::{BoardStatus, FrontEnd, Identity, ToBoard, ToHost};
pub use text::Text;

/// Version of the messages and of everything that they contain. Any change to a type that travels raises it.
pub const SCHEMA_VERSION: u8 = 3;
