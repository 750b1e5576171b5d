//! Tables in text: any separator, decimal comma, lines before the header, units in a line of their own; and the forms of text that state more.

mod cells;
mod columns;
mod labview;
mod layout;
mod lines;
mod read;
mod scope;
mod tektronix;
mod trace;

pub(crate) use cells::{Cell, cell};
pub(crate) use labview::read as read_labview;
pub use layout::TextLayout;
pub(crate) use layout::sniff;
#[cfg(feature = "formats-can")]
pub(crate) use lines::{Lines, encoding};
pub(crate) use read::read;
pub(crate) use scope::{is_scope, read as read_scope};
pub(crate) use tektronix::{is_tektronix, read as read_tektronix};
pub(crate) use trace::{is_trace, read as read_trace};
