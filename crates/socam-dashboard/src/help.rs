//! Help texts of all controls.

use egui::{Button, Grid, RichText, Role, ScrollArea, TextEdit, Ui, WidgetInfo};

use crate::commands::Command;
use crate::layout;
use crate::platform::Views;
use crate::view::Help;
use socam_chart::theme;

/// Controls of the frame around the views.
const FRAME: [(&str, Help); 2] = [
    (
        "Everywhere",
        &[
            (
                "EMERGENCY STOP; Esc",
                "cuts the command at once, from every view; the board also stops by itself half a second after it hears nothing",
            ),
            ("a view's name", "shows that view"),
            (
                "This view in a window of its own; Back to the main window; Show it here",
                "of the menu View: the view that is shown gets a window beside this one, with an emergency stop, until it is closed",
            ),
            (
                "Watch: ...",
                "the state of the watch, in every view and in the window's title: not judged, as usual, or its alarms; a click shows the watch",
            ),
            (
                "Ctrl+O; drop",
                "opens recordings (.mcap, .csv, .m, and tables of other programs), models and profiles (.toml), identifications and diagnoses (.json, or a report's folder), and the table of a fleet (.parquet)",
            ),
            (
                "Export what is seen",
                ".png and .svg are pictures; .csv has all samples in sight of the Time view, of channels that are drawn, and the points of the lines of other views",
            ),
            (
                "Open...; Try the virtual bench",
                "of a window without recordings: asks for files; connects to a bench in this program",
            ),
            (
                "Step ...; Copy the command",
                "check, identify, diagnose, record next, with the verdict of each for the recordings that are shown; a press shows its view, the right button copies the command that does the same",
            ),
            ("Cancel", "gives up what is being opened, saved, drawn or diagnosed; nothing is left of it"),
            ("Dismiss", "puts a message away"),
            (
                "Set units...; Channel of ...; Unit of ...; Take ...; Open with these",
                "for a file that does not state its units or times, which is drawn as plain numbers: a row for each column, with guesses to take; written to a mapping beside the file, with which it opens from then on",
            ),
            ("Choose here", "while a window of the desktop asks for a file: asks in this window instead"),
            ("Sort by ...", "a column's head sorts the table by it, and pressed again the other way round"),
        ],
    ),
    (
        "Menus",
        &[
            (
                "File",
                "New (forgets the signal), Open, Open recent (the last twelve files), Save (the signal), Save recording (as .csv or .m), Simulate (the model's answer to the shown recordings, over them), Export",
            ),
            (
                "Edit",
                "Undo, Redo: changes of the view in Time and Machine, of the input signal elsewhere; Cut, Copy, Paste: of the input signal, as text",
            ),
            ("View", "the views, light or dark, the size of everything"),
            ("Input Signal", "what the bench is to do"),
            (
                "Help; Close window; Search the help; Run: ...",
                "opens this and closes it, as F1 does; Esc closes it, too; the list is searched by words, and a command in it is run by a click",
            ),
        ],
    ),
];

/// Size of the frame and the title of a floating window, points.
const FRAME_OF_WINDOW: egui::Vec2 = egui::vec2(16.0, 48.0);

/// Title and controls of each part of the window.
fn parts() -> impl Iterator<Item = (&'static str, Help)> {
    let [everywhere, menus] = FRAME;
    let views = Views::NAMES.iter().map(|view| (view.name(), Views::help(*view)));
    std::iter::once(everywhere).chain(views).chain([menus]).filter(|(_, controls)| !controls.is_empty())
}

/// Whether a control of that name is explained.
#[must_use]
pub fn names(label: &str) -> bool {
    let label = label.to_lowercase();
    let is_view = Views::NAMES.iter().any(|view| label == view.name().to_lowercase());
    is_view
        || parts().flat_map(|(_, controls)| controls).any(|(control, _)| {
            control.split("; ").any(|name| match name.strip_suffix("...") {
                Some(start) => label.starts_with(&start.to_lowercase()),
                None => label == name.to_lowercase(),
            })
        })
}

/// The help's window: what is searched for, and whether it is open.
#[derive(Debug, Default)]
pub struct Window {
    /// Whether it is shown.
    pub is_open: bool,
    search: String,
    /// Whether the field of the search got the keyboard.
    is_focused: bool,
}

impl Window {
    /// Draws it. Returns a command if one was pressed.
    pub(crate) fn ui(&mut self, ctx: &egui::Context) -> Option<Command> {
        let mut open = self.is_open;
        let mut wanted = None;
        // It never covers the emergency stop.
        let free = layout::free(ctx).shrink(4.0);
        let window = egui::Window::new("What each control does").open(&mut open).default_size([720.0, 560.0]);
        let window = window.constrain_to(free).max_size(free.size() - FRAME_OF_WINDOW);
        window.collapsible(false).show(ctx, |ui| {
            let field = ui
                .add(TextEdit::singleline(&mut self.search).desired_width(f32::INFINITY).hint_text("search"));
            field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Search the help"));
            if !std::mem::replace(&mut self.is_focused, true) {
                field.request_focus();
            }
            let words = self.search.to_lowercase();
            let fits = |texts: &[&str]| {
                let all = texts.join(" ").to_lowercase();
                words.split_whitespace().all(|word| all.contains(word))
            };
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                wanted = commands(ui, &fits);
                for (view, controls) in parts() {
                    let of_view = controls.iter().filter(|(control, text)| fits(&[view, control, text]));
                    rows(ui, view, of_view);
                }
            });
        });
        self.is_open = open && wanted.is_none();
        self.is_focused &= self.is_open;
        wanted
    }
}

/// All commands with their keys; each is a button.
fn commands(ui: &mut Ui, fits: &dyn Fn(&[&str]) -> bool) -> Option<Command> {
    let mut wanted = None;
    let keys =
        |command: Command| command.keys().map(|keys| ui.ctx().format_shortcut(&keys)).unwrap_or_default();
    let all = Command::all().map(|command| (command, command.words(), keys(command)));
    let shown: Vec<_> = all.filter(|(_, words, keys)| fits(&["keys", words, keys])).collect();
    if shown.is_empty() {
        return None;
    }
    heading(ui, "Commands and their keys; Esc is the EMERGENCY STOP");
    Grid::new("keys").num_columns(2).spacing([16.0, 3.0]).striped(true).show(ui, |ui| {
        for (command, words, keys) in shown {
            let button = ui.add(Button::new(RichText::new(&words).color(theme::good(ui))).frame(false));
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Run: {words}")));
            if button.on_hover_text("Run it").clicked() {
                wanted = Some(command);
            }
            ui.label(keys);
            ui.end_row();
        }
    });
    wanted
}

fn rows<'a>(ui: &mut Ui, title: &str, rows: impl Iterator<Item = &'a (&'static str, &'static str)>) {
    let mut rows = rows.peekable();
    if rows.peek().is_none() {
        return;
    }
    heading(ui, title);
    Grid::new(title).num_columns(2).spacing([16.0, 5.0]).striped(true).show(ui, |ui| {
        for (control, text) in rows {
            ui.label(RichText::new(*control).color(theme::good(ui)));
            ui.add(egui::Label::new(socam_chart::numbers::plain(text)).wrap());
            ui.end_row();
        }
    });
}

fn heading(ui: &mut Ui, title: &str) {
    ui.add_space(6.0);
    ui.label(RichText::new(title).strong().size(15.0));
}
