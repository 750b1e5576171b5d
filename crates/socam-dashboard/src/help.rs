//! Help texts of all controls.

use egui::{Grid, RichText, ScrollArea, Window};

use crate::theme;
use crate::view::{Help, View};

/// Controls of the frame around the views.
const FRAME: [(&str, Help); 2] = [
    (
        "Everywhere",
        &[
            (
                "EMERGENCY STOP; Esc",
                "cuts the command at once, from every view; the board also stops by itself half a second after it hears nothing",
            ),
            (
                "a view's name",
                "shows that view; Ctrl+1, Ctrl+2 and so on are the views in the order of their tabs",
            ),
            (
                "Ctrl+O; drop",
                "opens recordings (.mcap, .csv, .m), models and profiles (.toml), identifications and diagnoses (.json, or a report's folder)",
            ),
            ("Ctrl+E", "exports what is seen: .png and .svg are pictures, .csv has the lines' points"),
            ("Ctrl+plus; Ctrl+minus; Ctrl+0", "the size of everything"),
            ("Cancel", "gives up what is being opened, saved, drawn or diagnosed; nothing is left of it"),
            ("Dismiss", "puts a message away"),
            ("Sort by ...", "a column's head sorts the table by it, and pressed again the other way round"),
        ],
    ),
    (
        "Menus",
        &[
            (
                "File",
                "New (forgets the signal), Open, Save (the signal), Save recording (as .csv or .m), Simulate (the model's answer to the shown recordings, over them), Export",
            ),
            ("Edit", "Undo, Redo, Cut, Copy, Paste: of the input signal, as text"),
            ("View", "the views, light or dark, the size of everything"),
            ("Input Signal", "what the bench is to do"),
            ("Help; Close window", "opens this with F1, and closes it"),
        ],
    ),
];

/// Title and controls of each part of the window.
fn parts() -> impl Iterator<Item = (&'static str, Help)> {
    let [everywhere, menus] = FRAME;
    let views = View::ALL.iter().map(|view| (view.name(), view.help()));
    std::iter::once(everywhere).chain(views).chain([menus]).filter(|(_, controls)| !controls.is_empty())
}

/// Whether a control of that name is explained.
#[must_use]
pub fn names(label: &str) -> bool {
    let label = label.to_lowercase();
    let is_view = View::ALL.iter().any(|view| label == view.name().to_lowercase());
    is_view
        || parts().flat_map(|(_, controls)| controls).any(|(control, _)| {
            control.split("; ").any(|name| match name.strip_suffix("...") {
                Some(start) => label.starts_with(&start.to_lowercase()),
                None => label == name.to_lowercase(),
            })
        })
}

/// The help's window.
pub(crate) fn window(ctx: &egui::Context, open: &mut bool) {
    Window::new("What each control does").open(open).default_size([720.0, 560.0]).collapsible(false).show(
        ctx,
        |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                for (view, controls) in parts() {
                    ui.add_space(6.0);
                    ui.label(RichText::new(view).strong().size(15.0));
                    Grid::new(view).num_columns(2).spacing([16.0, 5.0]).striped(true).show(ui, |ui| {
                        for (control, text) in controls {
                            ui.label(RichText::new(*control).color(theme::good(ui)));
                            ui.add(egui::Label::new(*text).wrap());
                            ui.end_row();
                        }
                    });
                }
            });
        },
    );
}
