//! The whole window: what is open, which view is shown, and what went wrong.

use std::path::{Path, PathBuf};

use egui::{Align, Button, Frame, Key, Layout as Direction, Margin, RichText, Stroke, Ui};
use socam_model::Model;

use crate::diagnosis::DiagnosisView;
use crate::document::Document;
use crate::draw::chart::Seen;
use crate::files::{Answer, Dialog, Purpose};
use crate::job::{CANCELLED, Job};
use crate::layout::{Layout, View};
use crate::live::{self, Live};
use crate::outside;
use crate::parameters::{self, Identification};
use crate::recording::Recording;
use crate::review::{Entry, Review};
use crate::spectra::Spectra;
use crate::theme;

/// Width of menus, tabs, the state of the bench and the emergency stop, points.
const ONE_ROW: f32 = 1060.0;

/// Something that went wrong or is worth knowing; it stays until it is put away.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Notice {
    pub(crate) text: String,
    pub(crate) grave: bool,
}

/// Drives a model by the inputs of the recording of that name; an error is one sentence.
pub type Simulate = fn(&Model, &str) -> Result<Recording, String>;

/// Everything that is shown.
pub struct Dashboard {
    pub(crate) simulate: Option<Simulate>,
    /// What is remembered.
    pub layout: Layout,
    pub(crate) entries: Vec<Entry>,
    /// The view over time.
    pub review: Review,
    /// The view over frequency.
    pub spectra: Spectra,
    pub(crate) checks: crate::spectra::check::Checks,
    pub(crate) model: Model,
    pub(crate) identification: Option<Identification>,
    /// The diagnosis.
    pub diagnosis: DiagnosisView,
    /// The bench that runs.
    pub live: Live,
    pub(crate) opening: Vec<Job<Result<Document, String>>>,
    saving: Vec<Job<outside::Saved>>,
    /// Files named before there was a window.
    waiting: Vec<String>,
    pub(crate) notices: Vec<Notice>,
    pub(crate) dialog: Option<Dialog>,
    pub(crate) help: bool,
    /// What was seen in the last pass, for exports.
    pub(crate) seen: Vec<Seen>,
    /// Recordings to hold out of a diagnosis that begins once all files are open.
    diagnose: Option<Vec<String>>,
    /// Whether the picture of this pass goes to a file.
    pub(crate) exporting: Option<PathBuf>,
    /// Files for the page to offer.
    #[cfg(target_arch = "wasm32")]
    pub(crate) leaving: Vec<(String, Vec<u8>)>,
    /// Whether the page is to ask for files.
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
        Self {
            simulate: None,
            live: Live::new(&layout.device),
            layout,
            entries: Vec::new(),
            review: Review::default(),
            spectra: Spectra::default(),
            checks: crate::spectra::check::Checks::default(),
            model,
            identification: None,
            diagnosis: DiagnosisView::default(),
            opening: Vec::new(),
            saving: Vec::new(),
            waiting: Vec::new(),
            notices: Vec::new(),
            dialog: None,
            help: false,
            seen: Vec::new(),
            exporting: None,
            diagnose: None,
            #[cfg(target_arch = "wasm32")]
            leaving: Vec::new(),
            #[cfg(target_arch = "wasm32")]
            wishes_files: false,
        }
    }

    /// The model that recordings are judged by.
    pub fn use_model(&mut self, model: Model) {
        self.model = model;
    }

    /// Says how a model is driven by a recording's inputs.
    pub fn simulate_by(&mut self, simulate: Simulate) {
        self.simulate = Some(simulate);
    }

    /// What went wrong and has not been put away.
    pub fn problems(&self) -> impl Iterator<Item = &str> {
        self.notices.iter().filter(|notice| notice.grave).map(|notice| notice.text.as_str())
    }

    /// Draws the shown recordings beside what the model makes of their inputs.
    pub(crate) fn simulate(&mut self, ctx: &egui::Context) {
        let Some(simulate) = self.simulate else { return };
        for entry in self.entries.iter().filter(|entry| entry.shown && entry.recording.path.is_some()) {
            let (model, run) = (self.model.clone(), entry.recording.about.name.clone());
            let title = format!("Simulating {}", crate::recording::short(&run));
            let work = move |_: &crate::job::Handle| simulate(&model, &run).map(Document::Recording);
            self.opening.push(Job::start(&title, ctx, work));
        }
    }

    /// Fonts and colours: once per window.
    pub fn set_up(&self, ctx: &egui::Context) {
        theme::apply(ctx, self.layout.look);
        ctx.set_zoom_factor(self.layout.zoom);
        crate::layout::set_panels(ctx, &self.layout.panels);
    }

    /// Opens files with the next pass.
    pub fn open(&mut self, paths: impl IntoIterator<Item = String>) {
        self.waiting.extend(paths);
    }

    /// Diagnoses the recordings once all of them are open; those named in `held_out` are the proof.
    pub fn diagnose(&mut self, held_out: Vec<String>) {
        self.diagnose = Some(held_out);
    }

    /// Adds a recording that is in memory.
    pub fn add_recording(&mut self, recording: Recording) {
        self.entries.push(Entry { recording, shown: true, shift_s: 0.0 });
    }

    /// Whether something is still being opened or computed.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.opening.is_empty()
            || !self.saving.is_empty()
            || !self.waiting.is_empty()
            || (self.diagnose.is_some() && !self.entries.is_empty())
            || self.diagnosis.is_busy()
            || self.spectra.is_busy()
            || self.checks.is_busy()
    }

    /// Shows a document.
    pub fn show(&mut self, document: Document) {
        match document {
            Document::Recording(recording) => {
                self.add_recording(recording);
                if !matches!(self.layout.view, View::Time | View::Frequency | View::Check) {
                    self.layout.view = View::Time;
                }
            }
            Document::Model(model) => {
                self.say(format!("{} is the model now", model.name));
                self.model = *model;
                self.checks.forget();
            }
            Document::Identification(identification) => {
                self.identification = Some(*identification);
                self.layout.view = View::Parameters;
            }
            Document::Diagnosis(diagnosis, model) => {
                self.diagnosis.show(
                    *diagnosis,
                    None,
                    model.map_or_else(|| self.model.clone(), |model| *model),
                );
                self.layout.view = View::Diagnosis;
            }
            Document::Signal(_) if !live::REACHABLE => self.warn(
                "that is an input signal: it takes a bench, which only the program on a desktop can reach",
            ),
            Document::Signal(file) => match self.live.signal.take(&file) {
                Ok(()) => self.layout.view = View::Live,
                Err(sentence) => self.warn(sentence),
            },
        }
    }

    /// Shows residuals beside the diagnosis that is shown.
    pub fn show_evidence(&mut self, evidence: socam_answer::Evidence) {
        self.diagnosis.evidence(evidence);
    }

    /// Says something that is not wrong.
    pub(crate) fn say(&mut self, text: impl Into<String>) {
        self.notices.push(Notice { text: text.into(), grave: false });
    }

    /// Says what went wrong.
    pub fn warn(&mut self, text: impl Into<String>) {
        let notice = Notice { text: text.into(), grave: true };
        if !self.notices.contains(&notice) {
            self.notices.push(notice);
        }
    }

    /// Opens the window that explains each control.
    pub fn show_help(&mut self) {
        self.help = true;
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
            && !self.entries.is_empty()
            && let Some(held_out) = self.diagnose.take()
        {
            let names = self.entries.iter().map(|entry| entry.recording.about.name.clone());
            self.diagnosis.start(&ctx, self.model.clone(), names.collect(), held_out);
            self.layout.view = View::Diagnosis;
        }
        self.live.listen();
        self.keys(&ctx);
        self.seen.clear();
        egui::Panel::top("menu")
            .frame(Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 6)))
            .show(ui, |ui| {
                self.bar(ui);
            });
        self.messages(ui);
        match self.layout.view {
            View::Live => {
                if let Some(path) = self.live.ui(ui, &mut self.seen) {
                    self.open([path]);
                    self.layout.view = View::Time;
                }
            }
            View::Time => self.review.ui(ui, &mut self.entries, &mut self.seen),
            View::Frequency => {
                egui::CentralPanel::default()
                    .show(ui, |ui| self.spectra.ui(ui, &self.entries, &self.model, &mut self.seen));
            }
            View::Check => {
                egui::CentralPanel::default().show(ui, |ui| self.checks.ui(ui, &self.entries, &self.model));
            }
            View::Parameters => {
                egui::CentralPanel::default().show(ui, |ui| parameters::ui(ui, self.identification.as_ref()));
            }
            View::Diagnosis => self.diagnosis_view(ui),
        }
        self.dialogs(&ctx);
        crate::help::window(&ctx, &mut self.help);
        self.layout.panels = crate::layout::panels(&ctx);
        self.export(&ctx);
    }

    fn diagnosis_view(&mut self, ui: &mut Ui) {
        let recordings: Vec<&Recording> =
            self.entries.iter().filter(|e| e.shown).map(|e| &e.recording).collect();
        let asked = self.diagnosis.ui(ui, &recordings, &self.model, &mut self.seen);
        let Some(profile) = asked else { return };
        if !live::REACHABLE {
            return self.put(Path::new("next.toml"), Ok(profile.to_toml().into_bytes()));
        }
        match self.live.signal.take(&profile) {
            Ok(()) => self.layout.view = View::Live,
            Err(sentence) => self.warn(sentence),
        }
    }

    /// Menus and tabs at the left, the emergency stop at the right; in two rows where there is no room for one.
    fn bar(&mut self, ui: &mut Ui) {
        let is_one_row = ui.available_width() >= ONE_ROW;
        ui.horizontal(|ui| {
            self.menus(ui);
            if is_one_row {
                ui.separator();
                self.tabs(ui);
            }
            if !live::REACHABLE {
                return;
            }
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                let text = RichText::new("EMERGENCY STOP").strong().color(egui::Color32::WHITE);
                let stop = ui.add(Button::new(text).fill(theme::STOP).stroke(Stroke::NONE));
                if stop.on_hover_text("Cuts the command at once, from every view (Esc)").clicked() {
                    self.live.emergency_stop();
                }
                if is_one_row {
                    self.live.lamp(ui);
                }
            });
        });
        if !is_one_row {
            ui.horizontal_wrapped(|ui| {
                self.tabs(ui);
                if live::REACHABLE {
                    ui.separator();
                    self.live.lamp(ui);
                }
            });
        }
    }

    fn tabs(&mut self, ui: &mut Ui) {
        for view in View::reachable() {
            if ui.selectable_label(self.layout.view == view, view.name()).clicked() {
                self.layout.view = view;
            }
        }
    }

    fn keys(&mut self, ctx: &egui::Context) {
        // Before anything else takes the key: nothing is more urgent.
        if self.live.is_connected() && ctx.input(|input| input.key_pressed(Key::Escape)) {
            self.live.emergency_stop();
        }
        self.shortcuts(ctx);
    }

    /// Begins to open what was dropped into the window or named before.
    #[cfg(not(target_arch = "wasm32"))]
    fn begin_to_open(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        self.waiting.extend(dropped.iter().map(|file| file.path().display().to_string()));
        for path in std::mem::take(&mut self.waiting) {
            if let Some(folder) = Path::new(&path).parent().filter(|folder| folder.is_dir()) {
                self.layout.folder = folder.into();
            }
            let title = format!("Opening {path}");
            self.opening.push(Job::start(&title, ctx, move |handle| crate::document::open(&path, handle)));
        }
    }

    /// Shows what has been opened.
    fn take_opened(&mut self) {
        // In order: what was named first gets the first colour.
        while let Some(result) = self.opening.first().and_then(Job::poll) {
            self.opening.remove(0);
            match result.and_then(|result| result) {
                Ok(document) => self.show(document),
                Err(sentence) if sentence == CANCELLED => {}
                Err(sentence) => self.warn(sentence),
            }
        }
    }

    /// What went wrong, and what is under way, below the menus.
    fn messages(&mut self, ui: &mut Ui) {
        if self.notices.is_empty() && self.opening.is_empty() && self.saving.is_empty() {
            return;
        }
        egui::Panel::top("messages").show(ui, |ui| {
            self.opening.retain(|job| !job.ui(ui));
            self.saving.retain(|job| !job.ui(ui));
            let mut put_away = None;
            for (index, notice) in self.notices.iter().enumerate() {
                let ground = if notice.grave { theme::alarm_ground(ui) } else { ui.visuals().faint_bg_color };
                Frame::new().fill(ground).corner_radius(4).inner_margin(Margin::symmetric(8, 4)).show(
                    ui,
                    |ui| {
                        ui.horizontal(|ui| {
                            if ui.button("Dismiss").clicked() {
                                put_away = Some(index);
                            }
                            ui.add(egui::Label::new(&notice.text).wrap());
                            ui.allocate_space(egui::vec2(ui.available_width(), 0.0));
                        });
                    },
                );
            }
            if let Some(index) = put_away {
                self.notices.remove(index);
            }
        });
    }

    fn dialogs(&mut self, ctx: &egui::Context) {
        let Some(dialog) = &mut self.dialog else { return };
        let Some(answer) = dialog.ui(ctx) else { return };
        let purpose = dialog.purpose;
        self.layout.folder = dialog.folder().into();
        self.dialog = None;
        if let Answer::Files(files) = answer {
            self.answered(ctx, purpose, files);
        }
    }

    /// Files have been chosen for something.
    pub(crate) fn answered(&mut self, ctx: &egui::Context, purpose: Purpose, files: Vec<PathBuf>) {
        match purpose {
            Purpose::Open => self.open(files.iter().map(|path| path.display().to_string())),
            Purpose::Export => self.exporting = files.into_iter().next(),
            Purpose::SaveSignal => {
                let text = self.live.signal.text();
                files.iter().for_each(|path| self.put(path, Ok(text.clone().into_bytes())));
            }
            Purpose::SaveRecording => files.iter().for_each(|path| self.save_recording(ctx, path)),
        }
    }

    /// Writes the first recording that is shown; on a thread, since it may be long.
    fn save_recording(&mut self, ctx: &egui::Context, path: &Path) {
        let Some(recording) = self.entries.iter().find(|entry| entry.shown).map(|entry| &entry.recording)
        else {
            return self.warn("no recording is shown; open one first");
        };
        let (recording, path) = (recording.clone(), path.to_owned());
        let title = format!("Saving {}", path.display());
        self.saving.push(Job::start(&title, ctx, move |handle| {
            outside::save(&recording, &path, handle).map(|bytes| (path, bytes))
        }));
    }

    /// What has been saved by now.
    fn take_saved(&mut self) {
        while let Some(result) = self.saving.first().and_then(Job::poll) {
            self.saving.remove(0);
            match result.and_then(|result| result) {
                Ok((path, None)) => self.say(format!("{} is written", path.display())),
                Ok((path, bytes)) => self.put(&path, Ok(bytes.unwrap_or_default())),
                Err(sentence) if sentence == CANCELLED => {}
                Err(sentence) => self.warn(sentence),
            }
        }
    }
}
