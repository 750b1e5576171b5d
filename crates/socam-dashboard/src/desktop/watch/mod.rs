//! Monitoring view: the model runs in parallel with the bench, or with a recording that is replayed, and an alarm names the change.

mod alarms;
mod charts;
mod episodes;
mod session;

use egui::{Button, ComboBox, RichText, ScrollArea, Ui};
use socam_job::Watch;
use socam_monitoring::{Alarm, Event, Overlay};

use super::fitting::command;
use super::fitting::options::{First, Form, Layout, Offered};
use crate::departure::diagnose_button;
use crate::layout;
use crate::progress::wake;
use crate::view::{Help, ViewPanel};
use episodes::Episodes;
use session::{Session, Source};
use socam_chart::chart::{self, Seen};
use socam_chart::theme;
use socam_workbench::View;
use socam_workbench::connection::Link;
use socam_workbench::job::CANCELLED;
use socam_workbench::recording::{Recording, short};
use socam_workbench::setup::Role;
use socam_workbench::{Departure, Request, Workspace};

/// Speeds of a replay, as multiples of the recording's own; `None` is as fast as possible.
const SPEEDS: [(Option<f64>, &str); 3] =
    [(None, "as fast as possible"), (Some(1.0), "1 x"), (Some(10.0), "10 x")];

impl Offered for Watch {
    const LAYOUT: Layout = Layout {
        first: &[
            First::new("false_alarms_per_hour", "False alarms per hour"),
            First::new("window_s", "Length of the window"),
            First::new("block_s", "Length of a block"),
            First::new("learn_s", "Length of the baseline"),
        ],
        left_out: &["model"],
        is_headed: false,
    };
}

/// Subject of the monitoring: the running bench, or a recording by name.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
enum Subject {
    #[default]
    Bench,
    Recording(String),
}

/// State of the view.
#[derive(Debug, Default)]
pub struct WatchView {
    subject: Option<Subject>,
    /// Names of the recordings that are healthy.
    healthy: Vec<String>,
    form: Form<Watch>,
    speed: Option<f64>,
    session: Option<Session>,
    /// The last snapshot, kept after the watch has ended.
    overlay: Option<Overlay>,
    /// The samples around the alarms.
    episodes: Episodes,
    /// Name of the model that ran beside it.
    model: String,
    /// Name of what was watched.
    name: String,
    /// Number of the link whose samples were watched; 0 for a recording.
    link: u64,
    problem: Option<String>,
    /// Number of the alarm whose window is shown.
    selected: Option<usize>,
    /// A watch begins as soon as there is something to watch.
    begins: bool,
}

impl ViewPanel for WatchView {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>) {
        let width = layout::panel(ui, "watch", 330.0);
        let panel = egui::Panel::left("watch").default_size(width).size_range(260.0..=520.0);
        let panel = panel.show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                ui.add_space(2.0);
                self.set_up(ui, workspace);
                if let Some(overlay) = &self.overlay {
                    ui.separator();
                    alarms::state(ui, overlay, &self.name);
                    ui.label(RichText::new(format!("model: {}", self.model)).small().color(theme::weak(ui)));
                    self.lead_on(ui, workspace);
                }
                if let Some(overlay) = &self.overlay {
                    alarms::list(ui, overlay, &mut self.selected);
                }
            });
        });
        layout::keep_panel(ui, "watch", panel.response.rect.width());
        egui::CentralPanel::default().show(ui, |ui| match &self.overlay {
            Some(overlay) => {
                let episode = self.selected.and_then(|number| self.episodes.of(number));
                charts::draw(ui, overlay, (self.selected, episode), seen);
            }
            None => chart::empty_state(
                ui,
                "Nothing is watched yet",
                "Choose a recording or the running bench at the left, tick recordings of the healthy bench, and press Watch. The model then runs beside it; an alarm says when, where and what has changed.",
            ),
        });
    }

    fn poll(&mut self, ctx: &egui::Context, workspace: &mut Workspace) {
        // A device that is being connected to is what will be watched.
        if self.begins && *workspace.bench.link() != Link::Opening && self.subject(workspace).is_some() {
            self.begin(ctx, workspace);
        }
        let Some(session) = &mut self.session else { return };
        session.take(&workspace.feed);
        for event in session.events().filter(|_| session.is_live) {
            match event {
                Event::Alarm(alarm) => {
                    let departure = Departure { link: self.link, onset_s: alarm.onset_s };
                    workspace.request(Request::Alarmed(departure, alarms::notice(&alarm)));
                }
                Event::Named(alarm) => workspace.request(Request::Alarm(alarms::sentence(&alarm))),
                _ => {}
            }
        }
        self.overlay = session.overlay().or(self.overlay.take());
        self.episodes = session.episodes();
        workspace.watch = self.overlay.as_ref().map(alarms::summary);
        let Some(end) = session.end() else { return };
        // What is over is looked at where it changed first, and not at its end.
        if !session.is_live && self.selected.is_none() {
            self.selected = self.alarms().first().map(|alarm| alarm.number);
        }
        self.session = None;
        self.problem = end.err().filter(|sentence| sentence != CANCELLED);
    }

    /// A watch of the bench ends when its user says so; it does not keep a picture waiting.
    fn is_busy(&self) -> bool {
        self.session.as_ref().is_some_and(|session| !session.is_live)
    }

    fn help() -> Help {
        &[
            (
                "Watch",
                "runs the model beside a recording or the running bench, and raises an alarm when the two disagree",
            ),
            ("What is watched; Speed", "the running bench, or a recording and how fast it is replayed"),
            (
                "healthy ...",
                "recordings of the bench in good order: they say what is usual; without one, the beginning of what is watched does",
            ),
            (
                "False alarms per hour; Length of the window; Length of a block; Length of the baseline",
                "of a healthy bench, over all channels; how much of the past is shown, and is searched for a cause; how much is compared with the model at once; how much of the beginning is healthy where no recording is ticked",
            ),
            (
                "Alarm ...; Diagnose from here",
                "draws the samples around the alarm; its causes are those that the score test ranks first; opens the recording from the change on, for a diagnosis",
            ),
        ]
    }
}

impl WatchView {
    /// Watches the running bench, or else the first recording, as soon as there is one; other recordings are healthy.
    pub fn begin_when_possible(&mut self) {
        self.begins = true;
    }

    /// Leads from the selected alarm of a recording to a diagnosis of what came after the change.
    fn lead_on(&self, ui: &mut Ui, workspace: &mut Workspace) {
        let alarm = self.alarms().iter().find(|alarm| self.selected == Some(alarm.number));
        let watched = named_short(workspace, &self.name);
        let Some(alarm) = alarm else { return };
        if self.link == workspace.bench.number() && self.link > 0 {
            ui.add_space(6.0);
            if diagnose_button(ui) {
                let departure = Departure { link: self.link, onset_s: alarm.onset_s };
                workspace.request(Request::Diagnose(departure));
            }
            return;
        }
        let Some(recording) = watched else { return };
        let Some(run) = since(&recording.about.name, alarm.onset_s, recording.samples.span_s()) else {
            return;
        };
        ui.add_space(6.0);
        let button = ui.button("Diagnose from here");
        let why = format!("Opens {run}, what came after the change, and leads to Diagnosis");
        if button.on_hover_text(why).clicked() {
            let whole = recording.about.name.clone();
            workspace.setup.use_as(&whole, Role::Unused);
            workspace.request(Request::Open(run));
            workspace.request(Request::Show(View::Diagnosis));
        }
    }

    /// Alarms so far.
    #[must_use]
    pub fn alarms(&self) -> &[Alarm] {
        self.overlay.as_ref().map_or(&[], |overlay| &overlay.alarms)
    }

    fn begin(&mut self, ctx: &egui::Context, workspace: &Workspace) {
        let subject = self.subject(workspace);
        self.begins = false;
        let others = workspace.shown().map(|(_, recording)| recording.about.name.clone());
        let is_watched = |name: &String| subject == Some(Subject::Recording(name.clone()));
        self.healthy = others.filter(|name| !is_watched(name)).collect();
        self.start(ctx, workspace, subject);
    }

    /// The subject that was chosen, if it is still there, else the first there is.
    fn subject(&self, workspace: &Workspace) -> Option<Subject> {
        let is_there = |subject: &Subject| match subject {
            Subject::Bench => !workspace.feed.channels.is_empty(),
            Subject::Recording(name) => workspace.shown().any(|(_, shown)| shown.about.name == *name),
        };
        let first =
            || workspace.shown().next().map(|(_, shown)| Subject::Recording(shown.about.name.clone()));
        self.subject.clone().filter(is_there).or_else(|| Some(Subject::Bench).filter(is_there)).or_else(first)
    }

    fn start(&mut self, ctx: &egui::Context, workspace: &Workspace, subject: Option<Subject>) {
        let task = match self.form.settings() {
            Ok(task) => task.clone(),
            Err(problem) => return self.problem = Some(problem),
        };
        let source = match subject {
            Some(Subject::Bench) => Some(Source::Live(workspace.feed.channels.to_vec())),
            Some(Subject::Recording(name)) => named(workspace, &name).map(|recording| {
                let (recording, speed) = (recording.clone(), self.speed);
                Source::Replay { recording, speed }
            }),
            None => None,
        };
        let (model, healthy) = (workspace.model().clone(), self.healthy(workspace));
        let session = source.map(|source| Session::start(&wake(ctx), task, model, source, healthy));
        (self.overlay, self.problem, self.selected) = (None, None, None);
        self.episodes = Episodes::default();
        self.model.clone_from(&workspace.model().name);
        let is_live = session.as_ref().is_some_and(|session| session.is_live);
        self.link = if is_live { workspace.bench.number() } else { 0 };
        self.name = session.as_ref().map_or_else(String::new, |session| short(&session.name).to_owned());
        self.session = session;
    }

    fn healthy(&self, workspace: &Workspace) -> Vec<Recording> {
        self.healthy.iter().filter_map(|name| named(workspace, name)).cloned().collect()
    }

    fn set_up(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        if let Some(session) = &self.session {
            if session.ui(ui) {
                self.session = None;
            }
            return;
        }
        if let Some(problem) = &self.problem {
            ui.label(RichText::new(problem).color(theme::alarm(ui)));
        }
        let subject = self.subject(workspace);
        if subject.is_none() {
            let text = "Open recordings (Ctrl+O), or connect to a bench in the Live view.";
            ui.label(RichText::new(text).color(theme::weak(ui)));
            if ui.button("Go to the Live view").clicked() {
                workspace.request(Request::Show(View::Live));
            }
            return;
        }
        if let Some(model) = crate::model_choice::ui(ui, workspace) {
            workspace.request(Request::Model(Box::new(model)));
        }
        self.choose_subject(ui, workspace, subject.as_ref());
        // The button stands above what grows and shrinks with the choices.
        let task = self.form.settings().cloned();
        let button = Button::new(RichText::new("Watch").strong());
        if ui.add_enabled(task.is_ok(), button).clicked() {
            let ctx = ui.ctx().clone();
            self.start(&ctx, workspace, subject.clone());
        }
        self.choose_healthy(ui, workspace, subject.as_ref());
        self.form.ui(ui);
        match (task, subject) {
            (Err(problem), _) => drop(ui.label(RichText::new(problem).color(theme::alarm(ui)))),
            (Ok(mut task), Some(Subject::Recording(name))) => {
                let notes = command::name_model(&mut task.model, workspace.model(), workspace.model());
                let healthy = self.healthy(workspace);
                if let Some(line) = command::of(&task, named(workspace, &name), ("--baseline", &healthy)) {
                    command::ui(ui, &line, &notes);
                }
            }
            _ => {}
        }
    }

    fn choose_subject(&mut self, ui: &mut Ui, workspace: &Workspace, subject: Option<&Subject>) {
        let name = |subject: &Subject| match subject {
            Subject::Bench => "the running bench".to_owned(),
            Subject::Recording(name) => short(name).to_owned(),
        };
        let bench = Some(Subject::Bench).filter(|_| !workspace.feed.channels.is_empty());
        let recordings = workspace.shown().map(|(_, shown)| Subject::Recording(shown.about.name.clone()));
        let all: Vec<Subject> = bench.into_iter().chain(recordings).collect();
        let label = ui.label("What is watched");
        let shown = ComboBox::from_id_salt("subject")
            .selected_text(subject.map_or_else(String::new, name))
            .width(ui.available_width() - 16.0)
            .truncate();
        let shown = shown.show_ui(ui, |ui| {
            for own in all {
                let text = name(&own);
                ui.selectable_value(&mut self.subject, Some(own), text);
            }
        });
        shown.response.labelled_by(label.id);
        if let Some(Subject::Recording(_)) = subject {
            ui.horizontal(|ui| {
                crate::together::level(ui);
                let label = ui.label("Speed");
                let text = SPEEDS.iter().find(|(speed, _)| *speed == self.speed).map_or("", |(_, text)| text);
                let shown = ComboBox::from_id_salt("speed").selected_text(text).show_ui(ui, |ui| {
                    for (speed, text) in SPEEDS {
                        ui.selectable_value(&mut self.speed, speed, text);
                    }
                });
                shown.response.labelled_by(label.id);
            });
        }
    }

    fn choose_healthy(&mut self, ui: &mut Ui, workspace: &Workspace, subject: Option<&Subject>) {
        let is_watched = |name: &String| subject == Some(&Subject::Recording(name.clone()));
        let names = workspace.shown().map(|(_, shown)| shown.about.name.clone());
        let others: Vec<String> = names.filter(|name| !is_watched(name)).collect();
        self.healthy.retain(|name| others.contains(name));
        if !others.is_empty() {
            ui.label("Recordings of the healthy bench");
        }
        for name in others {
            let mut on = self.healthy.contains(&name);
            let tick = ui.checkbox(&mut on, short(&name));
            let said = format!("healthy {}", short(&name));
            tick.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, &said));
            if tick.changed() {
                self.healthy.retain(|own| *own != name);
                self.healthy.extend(on.then_some(name));
            }
        }
        if let (true, Ok(task)) = (self.healthy.is_empty(), self.form.settings()) {
            let length_s = match subject {
                Some(Subject::Recording(name)) => named(workspace, name).and_then(|own| own.samples.span_s()),
                _ => None,
            };
            let length_s = length_s.map(|[from, to]| to - from);
            let (text, is_possible) = without_baseline(task.watching.settings().learn_s, length_s);
            let colour = if is_possible { theme::weak(ui) } else { theme::alarm(ui) };
            ui.add(egui::Label::new(RichText::new(text).small().color(colour)).wrap());
        }
    }
}

/// The shown recording whose name without its folder is this one.
fn named_short<'w>(workspace: &'w Workspace, name: &str) -> Option<&'w Recording> {
    workspace.shown().map(|(_, shown)| shown).find(|shown| short(&shown.about.name) == name)
}

/// The part of a recording from a time on, as it is opened; `None` of one that is a part itself, or has ended by then.
fn since(run: &str, from_s: f64, span_s: Option<[f64; 2]>) -> Option<String> {
    let [start_s, end_s] = span_s.filter(|[_, end_s]| *end_s > from_s)?;
    // The change may be estimated to lie before the first sample.
    let from_s = from_s.max(start_s);
    (!run.contains('@')).then(|| format!("{run}@{from_s:.3}..{end_s:.3}"))
}

/// What is taken as healthy where no recording is ticked, and whether that is possible.
fn without_baseline(learn_s: f64, length_s: Option<f64>) -> (String, bool) {
    match length_s {
        Some(length_s) if length_s <= learn_s => (
            format!(
                "No healthy recording is ticked, and the recording lasts {length_s:.0} s: its first {learn_s} s cannot be taken as healthy. Tick one, or shorten the baseline."
            ),
            false,
        ),
        _ => (
            format!(
                "No healthy recording is ticked: the first {learn_s} s of what is watched are taken as healthy."
            ),
            true,
        ),
    }
}

/// The shown recording of that name.
fn named<'w>(workspace: &'w Workspace, name: &str) -> Option<&'w Recording> {
    workspace.shown().map(|(_, shown)| shown).find(|shown| shown.about.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_after_a_change_can_be_opened() {
        let run = since("runs/a.mcap", 20.5, Some([0.0, 40.0]));
        assert_eq!(run.as_deref(), Some("runs/a.mcap@20.500..40.000"));
        assert!(socam_recording::Selection::parse(&run.unwrap()).is_ok());
        let whole = since("runs/a.mcap", -0.2, Some([0.0, 40.0]));
        assert_eq!(whole.as_deref(), Some("runs/a.mcap@0.000..40.000"));
        assert_eq!(since("runs/a.mcap", 41.0, Some([0.0, 40.0])), None);
        assert_eq!(since("runs/a.mcap@2..40", 20.5, Some([2.0, 40.0])), None);
    }

    #[test]
    fn a_recording_that_is_shorter_than_its_baseline_is_said_to_be() {
        let (text, is_possible) = without_baseline(30.0, Some(10.0));
        assert!(!is_possible && text.contains("the recording lasts 10 s"), "{text}");
        assert!(without_baseline(30.0, Some(40.0)).1 && without_baseline(30.0, None).1);
    }
}
