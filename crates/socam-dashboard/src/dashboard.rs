//! The whole window: what is open, which view is shown, and what went wrong.

mod commands;
mod frame;
mod menu;
mod opening;
mod own_windows;
mod rail;

use std::path::{Path, PathBuf};

use egui::{Frame, Key, Margin, Ui};
use socam_chart::chart::{self, Seen};
use socam_chart::{raster, theme};
use socam_core::State;
use socam_model::Model;
use socam_workbench::document::Document;
use socam_workbench::entry::Entry;
use socam_workbench::job::Job;
use socam_workbench::purpose::Purpose;
use socam_workbench::recording::Recording;
use socam_workbench::{Content, Departure, Request, Simulate, View, Workspace};

use crate::help;
use crate::layout::Layout;
use crate::platform::{self, Views};
use crate::progress::wake;

/// An error, which is shown until it is dismissed, or a remark.
#[derive(Debug, Clone)]
struct Notice {
    text: String,
    grave: bool,
    /// When it was first drawn, s of the window's clock.
    shown_s: Option<f64>,
    /// What a diagnosis is offered for.
    departure: Option<Departure>,
}

impl Notice {
    fn new(text: impl Into<String>, grave: bool) -> Self {
        Self { text: text.into(), grave, shown_s: None, departure: None }
    }
}

/// The dashboard with all its views.
pub struct Dashboard {
    /// The layout that is kept from one start to the next.
    pub layout: Layout,
    /// The open recordings and the model.
    pub workspace: Workspace,
    /// The states of the views.
    pub views: Views,
    /// The charts of this pass, for exports.
    pub(crate) seen: Vec<Seen>,
    pub(crate) opening: Vec<Job<opening::Opened>>,
    saving: Vec<Job<opening::Saved>>,
    notices: Vec<Notice>,
    /// Content that is saved once a place for it is chosen.
    content: Option<Content>,
    /// The window that explains each control.
    pub help: help::Window,
    /// Views that have a window of their own.
    apart: Vec<View>,
    /// Rectangle of the emergency stop in the last frame, points.
    stop_button: egui::Rect,
    /// The file that the picture of this pass is written to.
    exporting: Option<PathBuf>,
    /// Scripts that no font has.
    pub(crate) letters: platform::Letters,
    /// Parts that only this platform has.
    pub(crate) own: platform::Own,
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
        views.time.arrange(&layout.plots);
        let mut workspace = Workspace::new(model);
        workspace.has_bench = platform::HAS_BENCH;
        workspace.device.clone_from(&layout.device);
        workspace.stated.clone_from(&layout.stated);
        Self {
            layout,
            workspace,
            views,
            seen: Vec::new(),
            opening: Vec::new(),
            saving: Vec::new(),
            notices: Vec::new(),
            content: None,
            help: help::Window::default(),
            apart: Vec::new(),
            stop_button: egui::Rect::NOTHING,
            exporting: None,
            letters: platform::Letters::default(),
            own: platform::Own::default(),
        }
    }

    /// Sets the model that recordings are checked against.
    pub fn use_model(&mut self, model: Model) {
        self.workspace.set_model(model);
    }

    /// Sets the function that simulates a model with the inputs of a recording.
    pub fn simulate_by(&mut self, simulate: Simulate) {
        self.workspace.simulate = Some(simulate);
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

    /// Looks for scripts that no font has; called once per window that has fonts of the system.
    pub fn look_for_letters(&self, ctx: &egui::Context) {
        self.letters.listen(ctx);
    }

    /// Says, once for each, which scripts cannot be drawn.
    pub fn say_missing_letters(&mut self) {
        if let Some(sentence) = self.missing_letters() {
            self.say(sentence);
        }
    }

    /// Scripts that cannot be drawn, in one sentence; each is named once.
    pub fn missing_letters(&self) -> Option<String> {
        self.letters.sentence()
    }

    /// Takes the system's look, until the user chooses one.
    fn follow_system(&mut self, ctx: &egui::Context) {
        let system = ctx.system_theme().map(theme::Look::from);
        if let Some(look) = system.filter(|look| !self.layout.look_is_chosen && *look != self.layout.look) {
            self.layout.look = look;
            theme::apply(ctx, look);
        }
    }

    /// Adds a recording that is in memory.
    pub fn add_recording(&mut self, recording: Recording) {
        let entry = Entry::new(recording, &self.workspace.entries);
        self.workspace.entries.push(entry);
    }

    /// Whether something is still being opened or computed.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.opening.is_empty() || !self.saving.is_empty() || self.will_begin() || self.views.is_busy()
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
            Document::Session(session) => self.show_session(*session),
            Document::Signal(_) if !platform::HAS_BENCH => self.warn(
                "that is an input signal: it takes a bench, which only the program on a desktop can reach",
            ),
            Document::Signal(file) => match self.workspace.take_signal(&file) {
                Ok(()) => self.layout.view = View::Live,
                Err(sentence) => self.warn(sentence),
            },
        }
    }

    /// Shows a remark.
    pub(crate) fn say(&mut self, text: impl Into<String>) {
        self.notices.push(Notice::new(text, false));
    }

    /// Shows an error, unless it is shown already.
    pub fn warn(&mut self, text: impl Into<String>) {
        let notice = Notice::new(text, true);
        if self.problems().all(|problem| problem != notice.text) {
            self.notices.push(notice);
        }
    }

    /// Shows an alarm in every view; of several the last one alone.
    fn alarm(&mut self, departure: Departure, text: String) {
        self.notices.retain(|notice| notice.departure.is_none());
        self.notices.push(Notice { departure: Some(departure), ..Notice::new(text, true) });
    }

    /// Opens what was recorded since a departure, and shows the set-up of a diagnosis.
    fn diagnose_since(&mut self, departure: Departure) {
        match self.workspace.bench.recorded_since(departure.link, departure.onset_s) {
            Some(run) => {
                self.workspace.request(Request::Open(run));
                self.workspace.request(Request::Show(View::Diagnosis));
            }
            None => self.warn(
                "a diagnosis needs a second of recording since the change at least: record the device, and ask again",
            ),
        }
    }

    /// The title of the window: the states of the bench and of the watch are seen in the list of windows, too.
    #[must_use]
    pub fn title(&self) -> String {
        let bench = self.workspace.bench.state_text();
        match &self.workspace.watch {
            Some(watch) => format!("socam: {bench}; watch: {}", watch.text),
            None => format!("socam: {bench}"),
        }
    }

    /// Draws everything.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.follow_system(&ctx);
        self.begin_to_open(&ctx);
        self.take_opened();
        self.take_saved();
        self.begin(&ctx);
        self.workspace.listen();
        if self.workspace.recent != self.layout.recent {
            self.workspace.recent.clone_from(&self.layout.recent);
        }
        for view in Views::NAMES {
            self.views.get(*view).poll(&ctx, &mut self.workspace);
        }
        self.keys(&ctx);
        self.seen.clear();
        egui::Panel::top("menu")
            .frame(Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 6)))
            .show(ui, |ui| {
                self.bar(ui);
            });
        // Settings of the layout that other views show and change, too.
        self.workspace.spectra = self.views.time.spectra;
        self.workspace.units.clone_from(&self.views.time.units);
        let is_here = !self.is_apart(self.layout.view);
        if is_here {
            self.views.get(self.layout.view).bar(ui, &mut self.workspace);
        }
        crate::layout::set_free(&ctx, ui.available_rect_before_wrap());
        self.rail(ui);
        if is_here {
            self.views.get(self.layout.view).ui(ui, &mut self.workspace, &mut self.seen);
        } else {
            self.elsewhere(ui);
        }
        self.keep_picture(&ctx);
        self.own_windows(&ctx);
        self.views.time.spectra = self.workspace.spectra;
        self.answer_requests(&ctx);
        self.messages(&ctx);
        self.dialogs(&ctx);
        if let Some(command) = self.help.is_open.then(|| self.help.ui(&ctx)).flatten() {
            self.run(&ctx, command);
        }
        if self.workspace.bench.is_connected() {
            self.layout.device.clone_from(&self.workspace.device);
            self.layout.stated.clone_from(&self.workspace.stated);
        }
        self.layout.panels = crate::layout::panels(&ctx);
        self.layout.plots = self.views.time.arrangement();
        self.export(&ctx);
    }

    /// Saves the picture of a chart that was asked for.
    fn keep_picture(&mut self, ctx: &egui::Context) {
        if let Some(image) = chart::take_picture(ctx) {
            self.workspace.request(match raster::png(&image) {
                Ok(bytes) => Request::SaveAs(Purpose::SavePicture, "plot.png".into(), Content::Bytes(bytes)),
                Err(sentence) => Request::Warn(sentence),
            });
        }
    }

    fn answer_requests(&mut self, ctx: &egui::Context) {
        for request in self.workspace.take_requests() {
            match request {
                Request::Show(view) => self.layout.view = view,
                Request::Ask => self.ask(ctx, Purpose::Open, ""),
                Request::VirtualBench => {
                    self.workspace.device = "sim".into();
                    self.workspace.connect(wake(ctx));
                    self.layout.view = View::Live;
                }
                Request::Open(path) => self.open([path]),
                Request::Columns(run) => self.ask_for_columns(&run),
                Request::Save(path, bytes) => self.put(&path, Ok(bytes)),
                Request::SaveAs(purpose, name, content) => {
                    self.content = Some(content);
                    self.ask(ctx, purpose, &name);
                }
                Request::FitRange(range_s) => {
                    self.workspace.setup.range_s = Some(range_s);
                    self.layout.view = View::Identify;
                }
                Request::Signal(profile) if !platform::HAS_BENCH => {
                    self.put(Path::new("next.toml"), Ok(profile.to_toml().into_bytes()));
                }
                Request::Signal(profile) => self.show(Document::Signal(*profile)),
                Request::Model(model) => self.show(Document::Model(model)),
                Request::Alarm(text) => self.workspace.bench.mark_alarm(text),
                Request::Alarmed(departure, text) => self.alarm(departure, text),
                Request::Diagnose(departure) => self.diagnose_since(departure),
                Request::Say(text) => self.say(text),
                Request::Warn(text) => self.warn(text),
            }
        }
    }

    /// Stops a board at the press, not only the release, of a stop button, and at Esc where that is meant.
    fn stop_if_asked(&mut self, ctx: &egui::Context, button: egui::Rect, takes_escape: bool) {
        let is_asked = |input: &egui::InputState| {
            let on_button = || input.pointer.interact_pos().is_some_and(|at| button.contains(at));
            (takes_escape && input.key_pressed(Key::Escape))
                || (input.pointer.primary_pressed() && on_button())
        };
        if self.workspace.bench.is_commanded() && ctx.input(is_asked) {
            self.workspace.bench.emergency_stop();
        }
    }

    fn keys(&mut self, ctx: &egui::Context) {
        // First of all, so that no other control consumes the key, and no dialog covers the button.
        // A bench at rest has no command to be cut: there Esc puts away what is open above the views, and stops only where nothing is.
        let is_at_rest = matches!(self.workspace.bench.state(), Some(State::Idle));
        let only_puts_away =
            is_at_rest && (self.help.is_open || self.is_choosing() || ctx.egui_wants_keyboard_input());
        self.stop_if_asked(ctx, self.stop_button, !only_puts_away);
        if ctx.input(|input| input.key_pressed(Key::Escape)) {
            self.help.is_open = false;
        }
        self.shortcuts(ctx);
    }
}
