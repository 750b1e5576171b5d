//! [`Dataset`]: channels, units, times and gaps of a recording, and its samples block by block.

mod block;
mod blocks;
mod data;
mod even;
mod grid;
mod join;
mod keep;
mod open;
mod read;
mod regular;
mod scan;
mod shared;
mod source;
mod spill;
mod tally;
#[cfg(test)]
mod tests;

pub use block::{Block, Column, Loaded};
pub use blocks::Blocks;
pub use data::Dataset;
pub use grid::Carry;
pub use regular::Steps;
pub use shared::Shared;
