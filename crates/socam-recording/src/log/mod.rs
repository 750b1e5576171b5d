//! MCAP logs: their schemas, the crash-safe recorder, and the streaming reader.

pub(crate) mod attachments;
#[cfg(test)]
mod conformance;
pub(crate) mod contents;
#[cfg(test)]
mod deaths;
pub(crate) mod decode;
mod file;
mod inflate;
mod landmark;
pub(crate) mod names;
mod order;
pub(crate) mod parse;
mod queue;
pub(crate) mod record;
mod records;
pub(crate) mod recover;
pub(crate) mod reread;
pub(crate) mod sample;
pub(crate) mod scan;
pub(crate) mod schema;
pub(crate) mod sink;
mod summary;
mod unpack;
pub(crate) mod writer;
mod writing;
