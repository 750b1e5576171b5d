//! MCAP logs: their schemas, the crash-safe recorder, and the streaming reader.

pub(crate) mod decode;
#[cfg(target_arch = "wasm32")]
mod inflate;
pub(crate) mod read;
pub(crate) mod record;
mod records;
pub(crate) mod sample;
pub(crate) mod schema;
pub(crate) mod sink;
pub(crate) mod writer;

pub use decode::{AttachmentInfo, LogContents};

/// Profile named in the header of every log.
pub const PROFILE: &str = "socam";

/// Topic of samples, one message each.
pub const SAMPLE_TOPIC: &str = "/socam/sample";

/// Topic of the board's state and counters.
pub const STATUS_TOPIC: &str = "/socam/status";

/// Topic of profile phases, stops and faults.
pub const EVENT_TOPIC: &str = "/socam/event";

/// Name of the metadata record with versions and notes.
pub const METADATA_NAME: &str = "socam";

/// Name of the metadata record written when a recording is finished in order.
pub const SUMMARY_NAME: &str = "socam.summary";
