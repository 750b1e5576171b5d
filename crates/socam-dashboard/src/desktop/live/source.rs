//! The device of the live view in the panel at the left: its address, what must be said of it, and how well its samples arrive.

use egui::{Label, RichText, TextEdit, Ui};

use socam_chart::theme;
use socam_workbench::connection::{Connection, Link};
use socam_workbench::device::{FORMS, Needs, Stated, Unstated};

use super::parts::Action;

/// Height of what stands below the address, points: while an address is typed, and when the link is opened, no field below it moves.
const BELOW: f32 = 62.0;

/// Address of the device, what is said of it, and the state of the link.
pub(super) fn link(
    ui: &mut Ui,
    bench: &Connection,
    device: &mut String,
    stated: &mut Stated,
) -> Option<Action> {
    let mut action = None;
    let closed = *bench.link() == Link::Closed;
    let label = ui.label("Address");
    let field = TextEdit::singleline(device).desired_width(ui.available_width() - 8.0);
    let hint = "sim, serial, serial:PATH, tcp:HOST:PORT, or another device: Forms lists examples";
    let field = ui.add_enabled(closed, field).labelled_by(label.id).on_hover_text(hint);
    field.on_disabled_hover_text(device.as_str());
    ui.horizontal(|ui| {
        if closed {
            if ui.button("Connect").clicked() {
                action = Some(Action::Connect);
            }
            forms(ui, device);
        } else if ui.button(if *bench.link() == Link::Opening { "Cancel" } else { "Disconnect" }).clicked() {
            action = Some(Action::Disconnect);
        }
    });
    let top = ui.cursor().top();
    if closed {
        say(ui, Needs::of(device), stated);
    }
    if let Link::Open { board, .. } = bench.link() {
        ui.label(RichText::new(board).small().color(theme::weak(ui)));
    }
    health(ui, bench);
    ui.add_space((top + BELOW - ui.cursor().top()).max(0.0));
    if let Some(unstated) = bench.source().and_then(|source| source.unstated.as_ref()) {
        action = write(ui, unstated).or(action);
    }
    action
}

/// Addresses by way of example.
fn forms(ui: &mut Ui, device: &mut String) {
    let menu = ui.menu_button("Forms", |ui| {
        for (form, what) in FORMS {
            if ui.button(form).on_hover_text(what).clicked() {
                form.clone_into(device);
                ui.close();
            }
        }
    });
    menu.response
        .on_hover_text("What a device is called: choose a form, and write your own path or address into it");
}

/// Fields for what a device of this kind does not state.
fn say(ui: &mut Ui, needs: Needs, stated: &mut Stated) {
    let field = |ui: &mut Ui, name: &str, text: &mut String, hint: &str| {
        ui.horizontal(|ui| {
            let label = ui.label(name);
            let field = TextEdit::singleline(text).desired_width(ui.available_width() - 8.0);
            ui.add(field).labelled_by(label.id).on_hover_text(hint);
        });
    };
    match needs {
        Needs::Nothing => {
            let text = "It states its channels and units itself.";
            ui.add(Label::new(RichText::new(text).small().color(theme::weak(ui))).wrap());
        }
        Needs::Description => {
            let hint = "File that says what lines of text hold: names, units, clock. Without it, what the device does not state is drawn as plain numbers. Leave it empty for the own board.";
            field(ui, "Description", &mut stated.description, hint);
            let tick = ui.checkbox(&mut stated.takes_guesses, "Take units that names suggest");
            tick.on_hover_text("Signals whose names suggest none are left out");
        }
        Needs::Dbc => field(ui, "DBC", &mut stated.dbc, "File that says what the frames of the bus hold"),
    }
}

/// How well samples arrive.
fn health(ui: &mut Ui, bench: &Connection) {
    let small = |ui: &mut Ui, text: String, is_clean: bool| {
        let colour = if is_clean { theme::weak(ui) } else { theme::alarm(ui) };
        ui.add(Label::new(RichText::new(text).small().color(colour)).wrap())
    };
    if let Some(health) = bench.health().filter(|_| bench.source().is_none()) {
        let text = format!(
            "link: {} damaged frames, {} samples dropped, {} periods missed",
            health.link_errors, health.dropped, health.overruns
        );
        small(ui, text, health.link_errors + health.dropped + health.overruns == 0);
    }
    if let Some(state) = bench.source_state() {
        let trouble = state.trouble();
        let text =
            format!("{} samples arrived, {}", state.received, trouble.as_deref().unwrap_or("none lost"));
        let counted = format!("Lost samples are counted {}", state.counted_by);
        small(ui, text, trouble.is_none()).on_hover_text(counted);
        small(ui, state.times.clone(), true);
    }
}

/// What a device does not state, and a button that writes what is known.
fn write(ui: &mut Ui, unstated: &Unstated) -> Option<Action> {
    let text = format!("Drawn as plain numbers: {}.", unstated.sentence);
    ui.add(Label::new(RichText::new(text).small()).wrap());
    let hint = "Writes a file with names, units and clock, as far as they are known. Replace each \"?\" in it, and connect again: the device is then drawn in its units, and can be recorded.";
    let button = ui.button("Write description").on_hover_text(hint);
    button.clicked().then(|| Action::WriteDescription(unstated.description.clone()))
}
