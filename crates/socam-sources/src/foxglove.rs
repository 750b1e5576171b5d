//! The Foxglove WebSocket protocol: topics of a server as a device, and a server of a running recording.
//!
//! | module | what it is |
//! |---|---|
//! | `socket` | a WebSocket without input or output, by `tungstenite` |
//! | [`Connection`] | a client: it subscribes to topics and decodes their messages |
//! | [`Survey`] | what the topics hold, from the messages of a second |
//! | [`Topics`] | the device: rows out of messages |
//! | [`Publisher`] | a server's side of one client |
//!
//! Protocol: `docs/spec.md` of github.com/foxglove/ws-protocol. `foxglove.sdk.v1`, which the bridges of today ask for, has the same messages as
//! `foxglove.websocket.v1` where they are used here.

mod channel;
mod connection;
mod device;
mod publisher;
mod socket;
mod survey;

pub use connection::{Connection, Message, Said};
pub use device::Topics;
pub use publisher::{Publisher, SampleWriter};
pub use survey::Survey;

/// Subprotocols, the newer one first.
const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
/// First byte of a message with data, from the server.
const MESSAGE_DATA: u8 = 1;
/// The time of a message by the server, as a description names it.
const LOG_TIME: &str = "log_time";
