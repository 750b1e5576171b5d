//! Command profiles: a few parameters that give the same samples on board and host.
//!
//! Integers only. A [`Profile`] is plain data; a [`Generator`] has its state. "Micro" is a millionth of V or rad/s, as
//! [`Profile::command`] says.

mod checks;
mod chirp;
mod clock;
mod error;
mod generator;
mod multisine;
mod prbs;
mod shape;
mod sine;
mod staircase;
mod target;
#[cfg(test)]
mod tests;
mod triangle;
mod waveform;

pub use error::{ProfileError, ProfileKey};
pub use generator::{Generator, Setpoint};
pub use shape::{Command, Lines, MAX_LINES, Profile, Shape};
