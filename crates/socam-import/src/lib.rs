//! Recordings that other programs wrote, as a [`Dataset`](socam_recording::Dataset).
//!
//! A reader (`formats`, `text`, `tdms`) gives a source: groups of signals with a clock each. A mapping, read from a file or proposed from names
//! and units, says which signal is which channel; `times` and [`clocks`](socam_recording::clocks) put the clocks together; the result is a `Dataset`. [`open()`] is
//! how every command opens a recording, whatever wrote it. [`parts`] are what readers of running streams share with these.

mod counts;
mod dates;
mod error;
mod file;
mod formats;
mod import;
mod mapping;
mod offset;
mod open;
pub mod parts;
mod propose;
mod source;
mod tdms;
mod text;
mod time_names;
mod times;

pub use error::{ImportError, Result};
#[cfg(feature = "formats-can")]
pub use formats::can::{CanSet, CanSignals};
#[cfg(feature = "formats-ros")]
pub use formats::messages::{LiveMessages, MessageNumber};
pub use formats::{FileFormat, Hints, detect, fence::fenced, read};
pub use import::{Imported, Understood, import};
pub use mapping::{ChannelMap, Clock, Mapping, SCHEMA, Stamps, Time};
pub use open::{Opened, open, open_either, open_selection, probe};
pub use propose::{
    ClockChoice, ColumnChoice, Columns, Guessed, PLAIN_NUMBERS, Proposal, Proposed, import_guessed,
    import_stated, propose,
};
pub use socam_recording::clocks::Between;
pub use source::{Found, Group, Signal, Source, Wanted};
pub use text::TextLayout;
