//! What each open recording is used for.

use std::collections::BTreeMap;

use egui::{RichText, Ui};

use crate::recording::short;
use crate::review::Entry;
use socam_chart::table::{self, Table};

/// What a recording is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Role {
    /// It is fitted.
    #[default]
    Fit,
    /// It is not fitted, only predicted: the proof.
    HoldOut,
    /// It is left out.
    Unused,
}

/// Roles with their column, and what they mean.
const ROLES: [(Role, &str, &str); 3] = [
    (Role::Fit, "fit", "it is fitted"),
    (Role::HoldOut, "hold out", "it is not fitted, only predicted: the proof"),
    (Role::Unused, "no", "it is not used"),
];

const COLUMNS: [table::Column; 4] = [
    table::text("fit", 22.0),
    table::text("hold out", 48.0),
    table::text("no", 22.0),
    table::text("recording", 90.0),
];

/// Roles by the name of the recording. A recording that is hidden is not used unless somebody chose its role.
#[derive(Debug, Clone, Default)]
pub(super) struct Roles(BTreeMap<String, Role>);

impl Roles {
    pub(super) fn of(&self, entry: &Entry) -> Role {
        let usual = if entry.shown { Role::Fit } else { Role::Unused };
        self.0.get(&entry.recording.about.name).copied().unwrap_or(usual)
    }

    pub(super) fn set(&mut self, name: &str, role: Role) {
        self.0.insert(name.to_owned(), role);
    }

    /// Draws the recordings with a choice of role for each.
    pub(super) fn ui(&mut self, ui: &mut Ui, entries: &[Entry]) {
        let mut table = Table::new("roles", &COLUMNS);
        table.most_height = 150.0;
        let known = self.clone();
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
            let radio = ui.radio(self.of(entry) == *role, "");
            let said = format!("{}: {word}", short(name));
            let is_chosen = self.of(entry) == *role;
            radio.widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, true, is_chosen, &said));
            if radio.on_hover_text(*meaning).clicked() {
                self.set(name, *role);
            }
        });
    }
}
