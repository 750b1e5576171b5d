//! The bench's control core: what runs on the board, in the virtual board and in tests, unchanged.
//!
//! # Conventions
//!
//! - Every quantity carries its unit in its name: `clamp_uv` (microvolt), `speed_urad_s` (microradian per second),
//!   `timeout_us` (microsecond), `frequency_uhz` (microhertz). `_micro` is a millionth of the unit that the value's
//!   owner states: volt or rad/s for a [`Profile`], the channel's SI unit (rad/s, N m, ...) for a [`Channel`].
//! - What [`Board::tick`] runs is integer arithmetic only: the board has no floating-point unit, and integers make board
//!   and host agree bit for bit. Floating point ([`scaling`]) appears only where a bench is configured.
//! - Nothing here panics, allocates or blocks; arithmetic wraps or saturates only where it is written so.
//!
//! # Main types
//!
//! [`Profile`] (what to command) becomes a [`Generator`] (sample by sample); [`Config`] says how counts become SI and
//! what is watched; [`Board`] puts both behind [`Ports`] (the hardware) and the safety states of [`State`];
//! [`encoder::Encoder`] turns the count of a shaft into position and speed; a [`Ring`] carries each [`Sample`] from the sampling interrupt to the sender. [`Count`]
//! is what a board's channels are counted in: what only a board with encoders needs costs no other board time.
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

#[cfg(test)]
extern crate std;

mod atomic {
    pub(crate) use core::sync::atomic::{AtomicU32, Ordering};
}
mod applied;
mod average;
mod board;
pub mod bridge;
mod ceilings;
mod config;
mod count;
pub mod encoder;
mod fault;
mod fixed;
mod kind;
mod layout;
mod motor_check;
mod motor_watch;
mod ports;
mod profile;
mod request;
mod ring;
#[cfg(test)]
mod ring_tests;
mod safety;
mod sample;
pub mod scaling;
mod schedule;
mod sealed;
mod state;
mod status;
pub mod transducer;
mod triangle;
mod velocity;

pub use applied::Applied;
pub use average::{Average, conversions_per_sample};
pub use board::Board;
pub use ceilings::Ceilings;
pub use config::{Channel, ChannelKind, Config, ConfigError, Output, SpeedControl};
pub use count::Count;
pub use fault::Fault;
pub use kind::{BoardKind, GearmotorChannel};
pub use layout::{Layout, MAX_CHANNELS};
pub use motor_watch::MotorWatch;
pub use ports::{ConverterSilent, Ports};
pub use profile::{Command, Generator, Lines, MAX_LINES, Profile, ProfileError, ProfileKey, Setpoint, Shape};
pub use request::{Refusal, Request};
pub use ring::{Consumer, Producer, Ring, Stored};
pub use sample::{Flags, Sample};
pub use scaling::{MotorLine, Scale};
pub use state::State;
pub use status::Status;
