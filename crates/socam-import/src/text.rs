//! Tables in text: any separator, decimal comma, lines before the header, units in a line of their own.

mod cells;
mod layout;
mod read;

pub use layout::TextLayout;
pub(crate) use layout::sniff;
pub(crate) use read::read;
