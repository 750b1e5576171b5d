//! The samples of a recording, for drawing: the time to draw a range of them depends on the width of the picture, not on their number.
//!
//! Values are stored as 32-bit differences from the middle of their channel's range: the resolution is 1/16 000 000 of that range.
//! Short recordings stay in memory, long ones in an index file ([`index`]) that is built once.

mod cache;
mod envelope;
mod groups;
pub mod index;
mod moments;
mod pyramid;
mod stats;
mod stored;

pub use envelope::{Envelope, envelope};
pub use pyramid::{BASE, Extremes};
pub use stats::{Stats, stats};
pub use stored::Samples;

#[cfg(test)]
mod tests;
