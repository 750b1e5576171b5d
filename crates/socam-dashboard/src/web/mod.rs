//! The window in a browser: a page passes files to it, and offers the files that it writes for download.

mod checking;
mod frame;
mod own;
mod responding;
mod views;

pub(crate) use checking::{CheckOptions, CheckOptions as CheckTask, check};
pub(crate) use own::{Own, save};
pub(crate) use responding::ResponseOptions;
pub use views::Views;

/// Content of a file that can be opened.
pub type Found = socam_workbench::document::Document;

/// A page has no fonts of the system.
pub(crate) fn add_letters(_ctx: &egui::Context) {}

/// Whether a bench can be reached from here.
pub(crate) const HAS_BENCH: bool = false;
