//! What all views work on, and what they ask of the window.

use std::path::PathBuf;
use std::sync::Arc;

use socam_model::Model;
use socam_recording::{Channel, ProfileFile};

use crate::files::Purpose;
#[cfg(not(target_arch = "wasm32"))]
use crate::fitting::Setup;
use crate::live::Batch;
use crate::recording::Recording;
use crate::review::Entry;
use crate::view::View;
use socam_chart::chart::Seen;

/// What is saved once its place is known.
#[derive(Debug)]
pub enum Content {
    /// A file.
    Bytes(Vec<u8>),
    /// The folder of a diagnosis' report.
    #[cfg(not(target_arch = "wasm32"))]
    Report(Box<crate::diagnosis::Report>),
}

/// Something that a view asks of the window; it is done after the view is drawn.
#[derive(Debug)]
pub enum Request {
    /// Show another view.
    Show(View),
    /// Open a file.
    Open(String),
    /// Save a small file; a page in a browser offers it for download.
    Save(PathBuf, Vec<u8>),
    /// Ask where to save something, with a name to propose; a page in a browser offers it for download.
    SaveAs(Purpose, String, Content),
    /// Make a profile the input signal, and show it; a page in a browser, which has no bench, offers it for download.
    Signal(Box<ProfileFile>),
    /// Make a model the one that recordings are compared with.
    Model(Box<Model>),
    /// Mark an alarm in the recording that is being made, if one is.
    Alarm(String),
    /// Show a remark.
    Say(String),
    /// Show an error.
    Warn(String),
}

/// Samples of the running bench that have arrived since the last pass.
#[derive(Debug, Default)]
pub struct Feed {
    /// Channels of the bench; empty while no bench is connected.
    pub channels: Arc<Vec<Channel>>,
    /// The samples, the oldest first.
    pub batches: Vec<Arc<Batch>>,
}

/// The open recordings, the model, and requests to the window.
#[derive(Debug)]
pub struct Workspace {
    /// The open recordings.
    pub entries: Vec<Entry>,
    model: Model,
    /// The models that were used before.
    models: Vec<Model>,
    /// What the next identification or diagnosis is made of.
    #[cfg(not(target_arch = "wasm32"))]
    pub setup: Setup,
    /// Counts the models that have been set; results that depend on the model are kept with it.
    revision: u64,
    /// The charts of the last pass, for exports.
    pub seen: Vec<Seen>,
    pub(crate) requests: Vec<Request>,
    /// The running bench.
    pub feed: Feed,
}

impl Workspace {
    pub(crate) fn new(model: Model) -> Self {
        Self {
            entries: Vec::new(),
            model,
            models: Vec::new(),
            #[cfg(not(target_arch = "wasm32"))]
            setup: Setup::default(),
            revision: 0,
            seen: Vec::new(),
            requests: Vec::new(),
            feed: Feed::default(),
        }
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
        let before = std::mem::replace(&mut self.model, model);
        self.models.retain(|known| known.text != before.text && known.text != self.model.text);
        self.models.push(before);
        self.revision += 1;
    }

    /// Draws the set-up of a fit. Returns another model if one was chosen.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn setup_ui(&mut self, ui: &mut egui::Ui) -> Option<Model> {
        let mut known = self.models.clone();
        known.push(self.model.clone());
        self.setup.ui(ui, &self.entries, (&self.model, &known, self.revision))
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
