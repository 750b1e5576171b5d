//! What all views work on, and what they ask of the window.

use std::path::PathBuf;

use socam_model::Model;
use socam_recording::ProfileFile;

use crate::draw::chart::Seen;
use crate::recording::Recording;
use crate::review::Entry;
use crate::view::View;

/// Something that a view asks of the window; it is done after the view is drawn.
#[derive(Debug)]
pub enum Request {
    /// Show another view.
    Show(View),
    /// Open a file.
    Open(String),
    /// Save a small file; a page in a browser offers it for download.
    Save(PathBuf, Vec<u8>),
    /// Ask for a name, of which this is a proposal, and save a small file; a page in a browser offers it for download.
    SaveAs(String, Vec<u8>),
    /// Make a profile the input signal, and show it; a page in a browser, which has no bench, offers it for download.
    Signal(Box<ProfileFile>),
    /// Make a model the one that recordings are compared with.
    Model(Box<Model>),
    /// Show a remark.
    Say(String),
    /// Show an error.
    Warn(String),
}

/// The open recordings, the model, and requests to the window.
#[derive(Debug)]
pub struct Workspace {
    /// The open recordings.
    pub entries: Vec<Entry>,
    model: Model,
    /// Counts the models that have been set; results that depend on the model are kept with it.
    revision: u64,
    /// The charts of the last pass, for exports.
    pub seen: Vec<Seen>,
    pub(crate) requests: Vec<Request>,
}

impl Workspace {
    pub(crate) fn new(model: Model) -> Self {
        Self { entries: Vec::new(), model, revision: 0, seen: Vec::new(), requests: Vec::new() }
    }

    /// The model that recordings are compared with.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Number of the model: another one after it was replaced.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    pub(crate) fn set_model(&mut self, model: Model) {
        self.model = model;
        self.revision += 1;
    }

    /// The recordings that are shown, with their numbers, which determine their colours.
    pub fn shown(&self) -> impl Iterator<Item = (usize, &Recording)> {
        self.entries.iter().filter(|entry| entry.shown).map(|entry| (entry.number, &entry.recording))
    }

    /// Asks something of the window.
    pub fn request(&mut self, request: Request) {
        self.requests.push(request);
    }
}
