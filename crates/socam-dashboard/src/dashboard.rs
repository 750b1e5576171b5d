//! The whole window: what is open, which view is shown, and what went wrong.

mod frame;
mod opening;

use std::path::{Path, PathBuf};

use egui::{Frame, Key, Margin, Ui};
use socam_model::Model;

use crate::document::Document;
use crate::files::Dialog;
use crate::job::Job;
use crate::layout::Layout;
use crate::recording::Recording;
use crate::review::Entry;
use crate::view::{View, Views};
use crate::workspace::{Content, Request, Workspace};
use crate::{live, outside};
use socam_chart::theme;

/// An error or a remark; it is shown until it is dismissed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Notice {
    pub(crate) text: String,
    pub(crate) grave: bool,
    /// A file that a mapping would help to open.
    pub(crate) to_map: Option<String>,
}

/// Simulates a model with the inputs of the recording of that name; an error is one sentence.
pub type Simulate = fn(&Model, &str) -> Result<Recording, String>;

/// Everything that is shown.
pub struct Dashboard {
    pub(crate) simulate: Option<Simulate>,
    /// The layout that is kept from one start to the next.
    pub layout: Layout,
    /// The open recordings and the model.
    pub workspace: Workspace,
    /// The states of the views.
    pub views: Views,
    pub(crate) opening: Vec<Job<opening::Opened>>,
    saving: Vec<Job<outside::Saved>>,
    /// Files to open with the next pass.
    waiting: Vec<String>,
    pub(crate) notices: Vec<Notice>,
    pub(crate) dialog: Option<Dialog>,
    /// What the dialog that is open saves.
    content: Option<Content>,
    /// Whether the desktop's dialogs are used, and the one that is open.
    #[cfg(not(target_arch = "wasm32"))]
    is_native: bool,
    #[cfg(not(target_arch = "wasm32"))]
    native: Option<crate::native::Native>,
    pub(crate) help: crate::help::Window,
    /// Where the emergency stop was drawn in the last frame, points.
    stop_button: egui::Rect,
    /// Held-out recordings of a diagnosis that begins once all files are open.
    diagnose: Option<Vec<String>>,
    /// Whether a watch begins once all files are open.
    watches: bool,
    /// The file that the picture of this pass is written to.
    pub(crate) exporting: Option<PathBuf>,
    /// Files that the page offers for download.
    #[cfg(target_arch = "wasm32")]
    pub(crate) leaving: Vec<(String, Vec<u8>)>,
    /// Whether the page should ask for files.
    #[cfg(target_arch = "wasm32")]
    pub(crate) wishes_files: bool,
}

impl Default for Dashboard {
    fn default() -> Self {
        Self::new(Layout::default())
    }
}

impl Dashboard {
    /// A dashboard with nothing open, and the default bench's model.
    ///
    /// # Panics
    /// When the embedded model does not parse; a test of the model crate holds that it does.
    #[must_use]
    pub fn new(layout: Layout) -> Self {
        let model =
            Model::builtin("speed-o-cam").unwrap_or_else(|| unreachable!("the default model is embedded"));
        let mut views = Views::default();
        views.live.choose_device(&layout.device);
        views.time.arrange(&layout.plots);
        Self {
            simulate: None,
            layout,
            workspace: Workspace::new(model),
            views,
            opening: Vec::new(),
            saving: Vec::new(),
            waiting: Vec::new(),
            notices: Vec::new(),
            dialog: None,
            content: None,
            #[cfg(not(target_arch = "wasm32"))]
            is_native: false,
            #[cfg(not(target_arch = "wasm32"))]
            native: None,
            help: crate::help::Window::default(),
            stop_button: egui::Rect::NOTHING,
            exporting: None,
            diagnose: None,
            watches: false,
            #[cfg(target_arch = "wasm32")]
            leaving: Vec::new(),
            #[cfg(target_arch = "wasm32")]
            wishes_files: false,
        }
    }

    /// Sets the model that recordings are checked against.
    pub fn use_model(&mut self, model: Model) {
        self.workspace.set_model(model);
    }

    /// Sets the function that simulates a model with the inputs of a recording.
    pub fn simulate_by(&mut self, simulate: Simulate) {
        self.simulate = Some(simulate);
    }

    /// Uses the desktop's file dialogs; without a desktop the window draws its own.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn use_native_dialogs(&mut self) {
        self.is_native = true;
    }

    /// Errors that have not been dismissed.
    pub fn problems(&self) -> impl Iterator<Item = &str> {
        self.notices.iter().filter(|notice| notice.grave).map(|notice| notice.text.as_str())
    }

    /// Sets fonts and colours; called once per window.
    pub fn set_up(&self, ctx: &egui::Context) {
        theme::apply(ctx, self.layout.look);
        ctx.set_zoom_factor(self.layout.zoom);
        crate::layout::set_panels(ctx, &self.layout.panels);
    }

    /// Opens files with the next pass.
    pub fn open(&mut self, paths: impl IntoIterator<Item = String>) {
        self.waiting.extend(paths);
    }

    /// Diagnoses the recordings once all of them are open; those named in `held_out` are used for validation only.
    pub fn diagnose(&mut self, held_out: Vec<String>) {
        self.diagnose = Some(held_out);
    }

    /// Watches the running bench, or else the first recording, once all files are open; other recordings are healthy.
    pub fn watch(&mut self) {
        self.watches = true;
    }

    /// Adds a recording that is in memory.
    pub fn add_recording(&mut self, recording: Recording) {
        let entry = Entry::new(recording, &self.workspace.entries);
        self.workspace.entries.push(entry);
    }

    /// Whether something is still being opened or computed.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.opening.is_empty()
            || !self.saving.is_empty()
            || !self.waiting.is_empty()
            || (self.diagnose.is_some() && !self.workspace.entries.is_empty())
            || (self.watches && !self.workspace.entries.is_empty())
            || self.views.is_busy()
    }

    /// Shows a document.
    pub fn show(&mut self, document: Document) {
        match document {
            Document::Recording(recording) => {
                self.add_recording(recording);
                if !self.views.get(self.layout.view).uses_recordings() {
                    self.layout.view = View::Time;
                }
            }
            Document::Model(model) => {
                self.say(format!("{} is the model now", model.name));
                self.workspace.set_model(*model);
            }
            Document::Identification(identification) => {
                self.views.identify.show(*identification);
                self.layout.view = View::Identify;
            }
            Document::Diagnosis(diagnosis, model) => {
                self.views.diagnosis.show(
                    *diagnosis,
                    None,
                    model.map_or_else(|| self.workspace.model().clone(), |model| *model),
                );
                self.layout.view = View::Diagnosis;
            }
            Document::Layout(plots) => {
                self.views.time.arrange(&plots);
                self.layout.view = View::Time;
            }
            #[cfg(not(target_arch = "wasm32"))]
            Document::Fleet(opened) => {
                self.views.fleet.show(*opened);
                self.layout.view = View::Fleet;
            }
            Document::Signal(_) if !live::REACHABLE => self.warn(
                "that is an input signal: it takes a bench, which only the program on a desktop can reach",
            ),
            Document::Signal(file) => match self.views.live.signal.take(&file) {
                Ok(()) => self.layout.view = View::Live,
                Err(sentence) => self.warn(sentence),
            },
        }
    }

    /// Shows residuals beside the diagnosis that is shown.
    pub fn show_evidence(&mut self, evidence: socam_answer::Evidence) {
        self.views.diagnosis.evidence(evidence);
    }

    /// Shows a remark.
    pub(crate) fn say(&mut self, text: impl Into<String>) {
        self.notices.push(Notice { text: text.into(), grave: false, to_map: None });
    }

    /// Shows an error, unless it is shown already.
    pub fn warn(&mut self, text: impl Into<String>) {
        let notice = Notice { text: text.into(), grave: true, to_map: None };
        if !self.notices.contains(&notice) {
            self.notices.push(notice);
        }
    }

    /// Opens the window that explains each control.
    pub fn show_help(&mut self) {
        self.help.is_open = true;
    }

    /// Draws everything.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        #[cfg(not(target_arch = "wasm32"))]
        self.begin_to_open(&ctx);
        self.take_opened();
        self.take_saved();
        #[cfg(not(target_arch = "wasm32"))]
        if self.opening.is_empty()
            && !self.workspace.entries.is_empty()
            && let Some(held_out) = self.diagnose.take()
        {
            for name in held_out {
                self.workspace.setup.use_as(&name, crate::fitting::Role::HoldOut);
            }
            self.views.diagnosis.start(&ctx, &self.workspace);
            self.layout.view = View::Diagnosis;
        }
        #[cfg(not(target_arch = "wasm32"))]
        if self.opening.is_empty() && std::mem::take(&mut self.watches) {
            self.views.watch.begin_when_possible();
            self.layout.view = View::Watch;
        }
        for view in View::ALL {
            self.views.get(*view).poll(&ctx, &mut self.workspace);
        }
        self.keys(&ctx);
        self.workspace.seen.clear();
        egui::Panel::top("menu")
            .frame(Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 6)))
            .show(ui, |ui| {
                self.bar(ui);
            });
        self.views.get(self.layout.view).bar(ui);
        self.messages(ui);
        self.views.get(self.layout.view).ui(ui, &mut self.workspace);
        self.answer_requests(&ctx);
        self.dialogs(&ctx);
        if let Some(command) = self.help.is_open.then(|| self.help.ui(&ctx)).flatten() {
            self.run(&ctx, command);
        }
        self.layout.panels = crate::layout::panels(&ctx);
        self.layout.plots = self.views.time.arrangement();
        self.export(&ctx);
    }

    fn answer_requests(&mut self, ctx: &egui::Context) {
        for request in std::mem::take(&mut self.workspace.requests) {
            match request {
                Request::Show(view) => self.layout.view = view,
                Request::Open(path) => self.open([path]),
                Request::Save(path, bytes) => self.put(&path, Ok(bytes)),
                Request::SaveAs(purpose, name, content) => {
                    self.content = Some(content);
                    self.ask(ctx, purpose, &name);
                }
                Request::Signal(profile) if !live::REACHABLE => {
                    self.put(Path::new("next.toml"), Ok(profile.to_toml().into_bytes()));
                }
                Request::Signal(profile) => self.show(Document::Signal(*profile)),
                Request::Model(model) => self.show(Document::Model(model)),
                Request::Alarm(text) => self.views.live.mark_alarm(text),
                Request::Say(text) => self.say(text),
                Request::Warn(text) => self.warn(text),
            }
        }
    }

    fn keys(&mut self, ctx: &egui::Context) {
        // First of all, so that no other control consumes the key, and no dialog covers the button.
        let stop = |input: &egui::InputState| {
            let on_button = || input.pointer.interact_pos().is_some_and(|at| self.stop_button.contains(at));
            input.key_pressed(Key::Escape) || (input.pointer.primary_pressed() && on_button())
        };
        if self.views.live.is_connected() && ctx.input(stop) {
            self.views.live.emergency_stop();
        }
        self.shortcuts(ctx);
    }
}
