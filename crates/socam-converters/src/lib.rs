//! Drivers of the board's converters, on the traits of `embedded-hal`.
//!
//! Every access is verified: [`Ads8688`] sends channel and range with every conversion, [`Ad5761r`] is read back after every write.
//! A line that is cut, stuck or shorted is an [`Error`] at once, never a value. The [`hx711`] has no such check but the level of its last bit.
#![no_std]
#![cfg_attr(
    not(test),
    deny(
        clippy::arithmetic_side_effects,
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::unwrap_used
    )
)]

mod ad5761r;
mod ads8688;
pub mod hx711;

pub use ad5761r::Ad5761r;
pub use ads8688::{Ads8688, Order};

/// An error of a converter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Error<E> {
    /// An error of the bus.
    Bus(E),
    /// An unexpected answer: the chip is absent or not configured, or a line is stuck.
    NoAnswer,
}

impl<E> From<E> for Error<E> {
    fn from(error: E) -> Self {
        Self::Bus(error)
    }
}

/// Converts a 16-bit count around 0 V to the offset binary of both chips, and back.
fn offset_binary(count: i16) -> u16 {
    count as u16 ^ 0x8000
}
