//! State of the window that only a desktop has.

use std::path::Path;

use socam_workbench::View;
use socam_workbench::document::Document;
use socam_workbench::job::Handle;
use socam_workbench::recording::Recording;
use socam_workbench::save;
use socam_workbench::session::Session;

use super::columns::Pane;
use super::files::Dialog;
use super::fleet::Opened;
use super::native::Native;

/// Content of a file that can be opened.
#[derive(Debug)]
pub enum Found {
    /// A document.
    Document(Box<Document>),
    /// The table of a fleet.
    Fleet(Box<Opened>),
}

impl From<Document> for Found {
    fn from(document: Document) -> Self {
        Self::Document(Box::new(document))
    }
}

impl From<Opened> for Found {
    fn from(opened: Opened) -> Self {
        Self::Fleet(Box::new(opened))
    }
}

/// A result that a file holds: its path, and the result as text, by which a later one is known to be another.
type Kept = (String, String);

/// Files of the results that the views show.
#[derive(Debug, Default)]
pub(super) struct Results {
    pub(super) identification: Option<Kept>,
    pub(super) diagnosis: Option<Kept>,
}

/// State of the window that only a desktop has.
#[derive(Debug, Default)]
pub(crate) struct Own {
    /// Files to open with the next pass.
    pub(super) waiting: Vec<String>,
    /// The dialog of the window that is open.
    pub(super) dialog: Option<Dialog>,
    /// The window in which columns get names and units.
    pub(super) columns: Option<Pane>,
    /// Whether the desktop's dialogs are used, and the one that is open.
    pub(super) is_native: bool,
    pub(super) native: Option<Native>,
    /// Held-out recordings of a diagnosis that begins once all files are open.
    pub(super) diagnose: Option<Vec<String>>,
    /// The view that was asked for before the files were opened.
    pub(super) first_view: Option<View>,
    /// Whether a watch begins once all files are open.
    pub(super) watches: bool,
    /// The session whose files are being opened.
    pub(super) session: Option<Session>,
    /// Files of the results that are shown.
    pub(super) results: Results,
}

/// Writes a recording as `.csv` or `.m`, by the ending of the file's name.
///
/// # Errors
/// When there is such a file already, it cannot be written, or it was cancelled; one sentence.
pub(crate) fn save(recording: &Recording, path: &Path, handle: &Handle) -> Result<Option<Vec<u8>>, String> {
    save::save(recording, path, handle).map(|()| None)
}
