//! Messages between board and host, and their frames.
//!
//! A frame is `0x00 | COBS(version, !version, seq, payload, crc) | 0x00`: the payload is a [`ToBoard`] or [`ToHost`] in
//! postcard's encoding, `seq` counts the sender's frames, `crc` is a CRC-32 over everything before it (numbers little
//! endian). The second version byte confirms the first, so a peer of another [`SCHEMA_VERSION`] is recognised whatever
//! follows. The zero on both sides separates a frame from any invalid bytes before it.
//!
//! [`Encoder`] and [`Decoder`] do no input or output: the caller transports the bytes. [`BoardLink`] is the board's end of the
//! link, used by the board and the virtual board.
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
pub mod image;
mod link;
mod message;
mod text;

pub use batch::{BATCH_SAMPLES, SampleBatch};
pub use decoder::{Decoder, LinkCounts, LinkError};
pub use encoder::{BufferTooSmall, Encoder, MAX_FRAME};
pub use image::Image;
pub use link::BoardLink;
pub use message::{BoardStatus, EnableFeedback, FrontEnd, Identity, Start, ToBoard, ToHost};
pub use socam_core::BoardKind;
pub use text::Text;

/// Version of the messages and of everything that they contain. Any change to a transmitted type raises it.
pub const SCHEMA_VERSION: u8 = 6;
