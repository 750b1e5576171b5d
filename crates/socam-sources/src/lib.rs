//! Devices other than the own board as sources of samples.
//!
//! A [`Device`] is a state machine without input or output: it takes [`Chunk`]s of bytes with the host's times of arrival, and returns
//! rows and what was damaged; bytes that it wants to send are returned by [`Device::poll`]. A [`Timeline`] gives each row its time and its
//! number: by the device's clock if it has one, by the time of arrival otherwise; it counts what was lost, late or repeated.
//!
//! | module | device |
//! |---|---|
//! | [`text`] | lines of text: CSV, `key:value`, JSON, as sent by an Arduino, a Pico or a script; frames of bytes by COBS |
//! | [`moteus`] | a moteus servo drive behind an fdcanusb |
//! | [`odrive`] | an ODrive by its protocol of text |
//! | [`dynamixel`], [`feetech`] | servos on one bus ([`Servos`]), by the protocol 2 of Dynamixel or that of Feetech; only asked |
//! | `can` | a CAN bus behind an adapter that speaks slcan, whose signals a DBC describes; only listened to |
//! | `can::odrive`, `can::canopen` | an ODrive by CAN Simple; a drive by CANopen, commanded where its list of objects marks it |
//! | `foxglove` | topics of a Foxglove WebSocket server, such as a bridge of ROS 2; and such a server of a running recording |
//! | [`simulators`] | simulations of these drives, for tests and rehearsals |
//!
//! A [`Drive`] is a device that can be commanded, by the [`Order`] that its next question carries; [`Commanded`] is the only one that gives
//! orders: it follows a profile within [`Limits`], stops the drive at its end and at whatever goes wrong, and is itself a [`Device`].
//!
//! Values are SI. Times are ns of one host clock that never goes back.

/// Kelvins at 0 degrees Celsius, in which drives state their temperatures.
const ZERO_CELSIUS_K: f64 = 273.15;

mod aligner;
mod asking;
#[cfg(feature = "can")]
pub mod can;
mod commanded;
mod description;
mod device;
mod drive;
pub mod dynamixel;
mod error;
pub mod feetech;
#[cfg(feature = "foxglove")]
pub mod foxglove;
pub mod moteus;
pub mod odrive;
mod servos;
#[cfg(any(feature = "can", feature = "foxglove"))]
mod silence;
pub mod simulators;
pub mod text;
mod timeline;

pub use aligner::{Aligner, Kind};
pub use commanded::Commanded;
pub use description::{ClockColumn, Description, SCHEMA};
pub use device::{Chunk, Device, Heard, Numbering, Row};
pub use drive::{Commands, Drive, Limits, Order, Readiness, Standing, Watched};
pub use error::{Result, SourceError};
pub use servos::Servos;
pub use timeline::{ClockMap, Counts, Placed, Timeline};
