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
#[derive(Debug, Clone, Default)]
pub(crate) struct Letters;

impl Letters {
    pub(crate) fn by_the_system(&self, _ctx: &egui::Context) {}

    pub(crate) fn listen(&self, _ctx: &egui::Context) {}

    pub(crate) fn sentence(&self) -> Option<String> {
        None
    }
}

/// Whether a bench can be reached from here.
pub(crate) const HAS_BENCH: bool = false;
