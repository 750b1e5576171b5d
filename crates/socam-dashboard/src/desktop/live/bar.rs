//! The bar of the live view: Arm, Run, Stop, or Record and End of a device that is not commanded (all of them for a drive), the progress of the run, and one line of words. Nothing in it ever moves.

use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Button, Key, KeyboardShortcut, Label, Modifiers, ProgressBar, Rect, RichText, TextStyle, Ui, vec2,
};
use socam_core::State;

use socam_chart::theme;
use socam_workbench::Workspace;
use socam_workbench::connection::{Connection, Link};
use socam_workbench::device::Source;
use socam_workbench::run::Run;

const ARM: KeyboardShortcut = with_two(Key::A);
const RUN: KeyboardShortcut = with_two(Key::R);
const STOP: KeyboardShortcut = with_two(Key::D);

/// Shortcut with two modifiers, so that no slip of a finger moves the bench. Letters whose shortcut with Ctrl alone is another
/// command are not used.
const fn with_two(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

/// Sizes of the parts, points.
const BUTTON: egui::Vec2 = vec2(82.0, 30.0);
const WORDS_HEIGHT: f32 = 36.0;
const GAP: f32 = 6.0;

/// Content of the line of text.
struct Words {
    text: String,
    is_grave: bool,
    /// Label of a button that removes the text.
    action: Option<&'static str>,
}

/// Draws the bar. Its parts have fixed places, whatever their texts are.
pub(super) fn draw(ui: &mut Ui, workspace: &mut Workspace) {
    let height = BUTTON.y + GAP + WORDS_HEIGHT;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), egui::Sense::hover());
    // Widgets of a child do not move anything in the panel.
    let ui = &mut ui.new_child(egui::UiBuilder::new().max_rect(rect));
    let [arm, run, stop, record] = [0.0, 1.0, 2.0, 3.0].map(|place| {
        let left = rect.left() + place * (BUTTON.x + ui.spacing().item_spacing.x);
        Rect::from_min_size(egui::pos2(left, rect.top()), BUTTON)
    });
    let mut last = stop;
    match workspace.bench.source().cloned() {
        Some(source) if source.offer.is_some() => {
            run_buttons(ui, workspace, [arm, run, stop]);
            record_button(ui, workspace, why_no_record(workspace), record);
            last = record;
        }
        Some(source) => source_buttons(ui, workspace, &source, [arm, run.union(stop)]),
        None => run_buttons(ui, workspace, [arm, run, stop]),
    }
    let left = last.right() + 2.0 * ui.spacing().item_spacing.x;
    let progress = Rect::from_min_max(egui::pos2(left, rect.top()), egui::pos2(rect.right(), stop.bottom()));
    draw_progress(ui, workspace, progress);
    let below = Rect::from_min_max(egui::pos2(rect.left(), stop.bottom() + GAP), rect.max);
    words(ui, &mut workspace.bench, below);
}

/// Buttons of a board, or of a drive that follows profiles.
fn run_buttons(ui: &mut Ui, workspace: &mut Workspace, [arm, run, stop]: [Rect; 3]) {
    let why_not = why_no_arm(&workspace.bench).or_else(|| why_no_drive(workspace));
    if button(ui, arm, "Arm", why_not, ARM) {
        workspace.arm();
    }
    if button(ui, run, "Run", why_no_run(&workspace.bench), RUN) {
        workspace.bench.run();
    }
    if button(ui, stop, "Stop", why_no_stop(&workspace.bench), STOP) {
        workspace.bench.stop();
    }
}

/// A device that is not commanded from here is recorded by one press, and the bar says that no command leaves.
fn source_buttons(ui: &mut Ui, workspace: &mut Workspace, source: &Source, [record, words]: [Rect; 2]) {
    let why_not = source.unstated.as_ref().map(|_| {
        "A recording needs the units that the device does not state: write its description at the left, complete it, and connect again"
    });
    record_button(ui, workspace, why_not, record);
    let text = RichText::new(source.words()).small().color(theme::body(ui));
    let place = egui::Layout::left_to_right(egui::Align::Center).with_main_wrap(true);
    ui.scope_builder(egui::UiBuilder::new().max_rect(words).layout(place), |ui| {
        ui.add(Label::new(text).wrap())
    });
}

/// Begins a recording without a run, or ends it.
fn record_button(ui: &mut Ui, workspace: &mut Workspace, why_not: Option<&str>, rect: Rect) {
    let is_at_rest = matches!(workspace.bench.state(), None | Some(State::Idle));
    if workspace.bench.is_recording() && is_at_rest {
        if button(ui, rect, "End", None, STOP) {
            workspace.bench.end_recording();
        }
    } else if button(ui, rect, "Record", why_not, RUN) {
        workspace.record();
    }
}

/// Why a drive is not recorded without a run.
fn why_no_record(workspace: &Workspace) -> Option<&'static str> {
    let is_at_rest = matches!(workspace.bench.state(), None | Some(State::Idle));
    (!is_at_rest).then_some("a run is recorded anyway")
}

/// Why a drive, if one is connected, cannot be armed.
fn why_no_drive(workspace: &Workspace) -> Option<&'static str> {
    let offer = workspace.bench.offer()?;
    if workspace.bench.source_state().is_some_and(|state| state.away.is_some()) {
        return Some("nothing arrives from the drive");
    }
    if workspace.drive.limits(offer.effort).is_none() {
        return Some("set both limits at the left first");
    }
    workspace.drive.why_not()
}

/// A button that is disabled for a reason, or does what its tip says. True when it or its keys were pressed.
fn button(ui: &mut Ui, rect: Rect, name: &str, why_not: Option<&str>, keys: KeyboardShortcut) -> bool {
    let tip = match name {
        "Arm" => "Load the signal and watch all limits; nothing moves",
        "Run" => "The bench moves, and is recorded",
        "Record" => "Writes what arrives from now on into a file; no command leaves for the device by that",
        "End" => "Closes the file; the device is shown as before",
        _ => "Ramps down gently",
    };
    let tip = format!("{tip} ({})", ui.ctx().format_shortcut(&keys));
    let button = Button::new(RichText::new(name).size(15.0)).min_size(rect.size());
    let shown = ui.add_enabled_ui(why_not.is_none(), |ui| ui.put(rect, button));
    let response = shown.inner.on_hover_text(tip).on_disabled_hover_text(why_not.unwrap_or_default());
    // Keys typed into a dialog are meant for it; stopping is always meant.
    let is_heard = name == "Stop" || ui.ctx().memory(|memory| memory.top_modal_layer().is_none());
    // Keys that do nothing here may be those of another button.
    let is_possible = why_not.is_none();
    let pressed = is_heard && is_possible && ui.ctx().input_mut(|input| input.consume_shortcut(&keys));
    why_not.is_none() && (response.clicked() || pressed)
}

fn why_no_arm(bench: &Connection) -> Option<&'static str> {
    match bench.state() {
        None => Some("connect to a board first"),
        Some(State::Idle) if bench.is_recording() && bench.offer().is_some() => {
            Some("end the recording first: a run has a file of its own")
        }
        Some(State::Idle) if bench.is_recording() => Some("the recording is being closed"),
        Some(State::Idle) => None,
        Some(State::Armed) => Some("the bench is armed already"),
        Some(State::Running | State::Stopping) => Some("the bench moves; stop it first"),
        Some(State::Fault) => Some("clear the fault first"),
    }
}

fn why_no_run(bench: &Connection) -> Option<&'static str> {
    match bench.state() {
        Some(State::Armed) if bench.is_recording() => Some("the run begins"),
        Some(State::Armed) => None,
        Some(State::Running | State::Stopping) => Some("the bench runs already"),
        _ => Some("arm the bench first"),
    }
}

fn why_no_stop(bench: &Connection) -> Option<&'static str> {
    match bench.state() {
        Some(State::Armed | State::Running | State::Stopping) => None,
        _ => Some("nothing moves, and nothing is armed"),
    }
}

/// Elapsed time, planned end and time left of the run.
fn draw_progress(ui: &mut Ui, workspace: &Workspace, rect: Rect) {
    let is_planned = workspace.bench.last_run().is_some_and(|run| run.planned_s > 0.0);
    let source = workspace.bench.source().filter(|_| !is_planned).map(|_| workspace.bench.source_state());
    let text = match workspace.bench.last_run() {
        Some(run) if source.is_some() && run.is_recorded() => {
            let counts = source.flatten().and_then(|state| state.recorded);
            let counts =
                counts.map_or_else(String::new, |[rows, lost]| format!(", {rows} samples, {lost} lost"));
            format!("recording: {:.1} s{counts}", run.elapsed_s())
        }
        Some(run) if source.is_some() => format!("recorded {:.1} s", run.elapsed_s()),
        None if source.is_some() && workspace.bench.offer().is_none() => "not recorded".into(),
        None => {
            let file = workspace.present_signal().settings.file();
            let ramp = if file.ramp_s > 0.0 { ", ramp included" } else { "" };
            format!("planned: {:.1} s{ramp}", file.duration_s + file.ramp_s)
        }
        Some(run) => {
            let (elapsed, planned) = (run.elapsed_s(), run.planned_s);
            if run.is_recorded() {
                format!("{elapsed:.1} s of {planned:.1} s, {:.1} s left", (planned - elapsed).max(0.0))
            } else {
                format!("ended after {elapsed:.1} s of {planned:.1} s")
            }
        }
    };
    let share = match (source, workspace.bench.last_run()) {
        // It has no planned end: the bar is full while it is made.
        (Some(_), run) => f64::from(u8::from(run.is_some_and(Run::is_recorded))),
        (None, run) => run.map_or(0.0, |run| run.elapsed_s() / run.planned_s.max(1e-3)),
    };
    // An empty bar would keep its round end.
    let fill = if share > 0.0 { ui.visuals().selection.bg_fill } else { egui::Color32::TRANSPARENT };
    let bar = ProgressBar::new(share.clamp(0.0, 1.0) as f32)
        .fill(fill)
        .desired_width(rect.width())
        .desired_height(rect.height())
        .corner_radius(4)
        .text(text);
    ui.put(rect, bar);
}

/// The most important thing to say: a fault, an error, or what comes next.
fn message(bench: &Connection) -> Words {
    let fault = bench.health().and_then(|health| health.fault.clone());
    if let Some(text) = fault {
        return Words { text, is_grave: true, action: Some("Clear fault") };
    }
    if let Some(text) = bench.problem() {
        return Words { text: text.to_owned(), is_grave: true, action: Some("Dismiss") };
    }
    match bench.source() {
        Some(source) if source.offer.is_some() => return of_drive(bench),
        Some(source) => return of_source(bench, source),
        None => {}
    }
    let text = match (bench.link(), bench.state()) {
        (Link::Closed, _) => "no device is connected: name one below, and connect",
        (Link::Opening, _) => "asking the device who it is, or listening to it",
        (_, Some(State::Idle)) => "at rest: Arm loads the signal and watches all limits, and nothing moves",
        (_, Some(State::Armed)) => "armed: Run moves the bench and records it",
        (_, Some(State::Running)) => "the bench moves: Stop ramps it down, Esc cuts the command at once",
        (_, Some(State::Stopping)) => "the bench ramps down; Esc cuts the command at once",
        (_, Some(State::Fault)) => "the board is in fault and says no reason",
        (Link::Open { .. }, None) => "the board is connected; waiting for its state",
    };
    Words { text: text.to_owned(), is_grave: false, action: None }
}

/// Why nothing arrives from a drive, or what comes next.
fn of_drive(bench: &Connection) -> Words {
    let at_rest = || bench.source_state().and_then(|state| state.away.clone());
    let text = match bench.state() {
        Some(State::Armed) => {
            "armed, and nothing was sent yet: Run moves the drive within its limits, and records it; Stop disarms"
        }
        Some(State::Running) => "the drive follows the signal: Stop lets it fade, Esc stops it at once",
        Some(State::Stopping) => "the signal fades, and the drive stops; Esc stops it at once",
        _ => {
            if let Some(text) = at_rest() {
                return Words { text, is_grave: true, action: None };
            }
            if bench.is_recording() {
                "recorded, and not commanded: End closes the file"
            } else {
                "asked only: Arm compares the signal with the limits, and nothing is sent; Record writes what arrives"
            }
        }
    };
    Words { text: text.into(), is_grave: false, action: None }
}

/// Why nothing arrives from a source, what it does not state, or what comes next.
fn of_source(bench: &Connection, source: &Source) -> Words {
    if let Some(text) = bench.source_state().and_then(|state| state.away.clone()) {
        return Words { text, is_grave: true, action: None };
    }
    let text = match &source.unstated {
        Some(_) => "drawn as plain numbers: write a description at the left, complete it, and connect again to record".into(),
        None if bench.is_recording() => "recorded: End closes the file".into(),
        None => "samples arrive: Record writes them into a file".into(),
    };
    Words { text, is_grave: false, action: None }
}

fn words(ui: &mut Ui, bench: &mut Connection, rect: Rect) {
    let Words { text, is_grave, action } = message(bench);
    let colour = if is_grave { theme::alarm(ui) } else { theme::weak(ui) };
    if is_grave {
        ui.painter().rect_filled(rect, 4.0, theme::alarm_ground(ui));
    }
    let inner = rect.shrink2(vec2(6.0, 0.0));
    let place = egui::Layout::right_to_left(egui::Align::Center);
    let mut pressed = None;
    ui.scope_builder(egui::UiBuilder::new().max_rect(inner).layout(place), |ui| {
        pressed = action.filter(|action| ui.button(*action).clicked());
        // Two lines at most, so that the bar keeps its height; the whole text is shown at the pointer.
        let font = TextStyle::Body.resolve(ui.style());
        let mut job = LayoutJob::simple(text.clone(), font, colour, 0.0);
        job.wrap = TextWrapping { max_rows: 2, max_width: ui.available_width(), ..TextWrapping::default() };
        let words = |ui: &mut Ui| {
            let galley = ui.painter().layout_job(job);
            let is_cut = galley.elided;
            let shown = ui.add(Label::new(galley));
            if is_cut { shown.on_hover_text(text) } else { shown }
        };
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), words);
    });
    match pressed {
        Some("Clear fault") => bench.clear_fault(),
        Some(_) => bench.set_problem(None),
        None => {}
    }
}
