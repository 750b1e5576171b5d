//! Recordings that other programs wrote, as a [`Dataset`](socam_recording::Dataset).

mod align;
mod dates;
mod error;
mod file;
mod formats;
mod import;
mod mapping;
mod offset;
mod open;
mod propose;
mod source;
mod tdms;
mod text;
mod times;
pub mod unit;

pub use error::{ImportError, Result};
pub use formats::{Kind, detect, fence::fenced, read};
pub use import::{Imported, Understood, import};
pub use mapping::{Between, ChannelMap, Clock, Mapping, SCHEMA, Stamps, Time};
pub use open::{Opened, open, open_either, open_selection, probe};
pub use propose::{Proposal, Proposed, import_stated, propose};
pub use source::{Found, Group, Signal, Source, Wanted};
pub use text::TextLayout;
