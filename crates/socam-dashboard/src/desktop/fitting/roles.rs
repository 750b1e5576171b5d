//! Choice of the role of each open recording.

use egui::{RichText, Ui};

use socam_chart::table::{self, Table};
use socam_workbench::entry::Entry;
use socam_workbench::recording::short;
use socam_workbench::setup::{Role, Roles};

/// Roles with their column, and what they mean.
const ROLES: [(Role, &str, &str); 3] = [
    (Role::Fit, "fit", "it is fitted"),
    (Role::HoldOut, "hold out", "it is not fitted, only predicted: the proof"),
    (Role::Unused, "unused", "it is not used"),
];

const COLUMNS: [table::Column; 4] = [
    table::text("fit", 22.0),
    table::text("hold out", 48.0),
    table::text("unused", 44.0),
    table::text("recording", 90.0),
];

/// Draws the recordings with a choice of role for each.
pub(super) fn ui(ui: &mut Ui, roles: &mut Roles, entries: &[Entry]) {
    let mut table = Table::new("roles", &COLUMNS);
    table.most_height = 150.0;
    let known = roles.clone();
    let key = |entry: &Entry, column: usize| match column {
        3 => table::Key::from(short(&entry.recording.about.name)),
        _ => table::Key::Number(f64::from(u8::from(known.of(entry) != ROLES[column].0))),
    };
    table.show(ui, entries, key, |ui, entry, column| {
        let name = &entry.recording.about.name;
        let Some((role, word, meaning)) = ROLES.get(column) else {
            ui.label(RichText::new(short(name)).strong()).on_hover_text(name);
            return;
        };
        let radio = ui.radio(roles.of(entry) == *role, "");
        let said = format!("{}: {word}", short(name));
        let is_chosen = roles.of(entry) == *role;
        radio.widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, true, is_chosen, &said));
        if radio.on_hover_text(*meaning).clicked() {
            roles.set(name, *role);
        }
    });
}
