//! Notes on moments of recordings: a list to add to, to change and to clear. They are marked in the plots, and are part of a session.

use egui::{Button, ComboBox, DragValue, Grid, Key, RichText, TextEdit, Ui, Window};

use socam_chart::table::heads;
use socam_chart::theme;
use socam_workbench::entry::Entry;
use socam_workbench::recording::short;
use socam_workbench::session::Note;

use crate::layout;

/// The window of notes.
#[derive(Debug)]
pub(super) struct Notes {
    /// Moment of the next note on the time axis, s.
    time_s: f64,
    text: String,
    /// Number of the recording that gets it; the first one that is shown, where that is gone.
    of: usize,
    is_new: bool,
}

impl Notes {
    /// A window whose next note is of this moment.
    pub(super) fn at(time_s: f64) -> Self {
        Self { time_s, text: String::new(), of: 0, is_new: true }
    }

    /// Draws it; false once it is closed.
    pub(super) fn ui(&mut self, ctx: &egui::Context, entries: &mut [Entry]) -> bool {
        let mut open = true;
        let free = layout::free(ctx);
        Window::new("Notes")
            .open(&mut open)
            .collapsible(false)
            .constrain_to(free)
            .default_width(460.0)
            .pivot(egui::Align2::CENTER_CENTER)
            .default_pos(free.center())
            .show(ctx, |ui| {
                self.next(ui, entries);
                ui.separator();
                list(ui, entries);
            });
        open
    }

    /// The fields of the next note.
    fn next(&mut self, ui: &mut Ui, entries: &mut [Entry]) {
        let shown: Vec<usize> =
            entries.iter().filter(|entry| entry.shown).map(|entry| entry.number).collect();
        let Some(first) = shown.first() else {
            ui.label("No recording is shown.");
            return;
        };
        if !shown.contains(&self.of) {
            self.of = *first;
        }
        let name = |number: usize| {
            let entry = entries.iter().find(|entry| entry.number == number);
            entry.map_or(String::new(), |entry| short(&entry.recording.about.name).to_owned())
        };
        let mut is_added = false;
        ui.horizontal(|ui| {
            ui.label("At");
            ui.add(DragValue::new(&mut self.time_s).speed(0.01).max_decimals(6).suffix(" s"));
            ui.label("of");
            ComboBox::from_id_salt("noted").selected_text(name(self.of)).width(180.0).show_ui(ui, |ui| {
                for number in &shown {
                    ui.selectable_value(&mut self.of, *number, name(*number));
                }
            });
        });
        ui.horizontal(|ui| {
            let field = TextEdit::singleline(&mut self.text).hint_text("What is seen there");
            let field = ui.add(field.desired_width(ui.available_width() - 90.0));
            field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Text of the note"));
            if std::mem::take(&mut self.is_new) {
                field.request_focus();
            }
            is_added = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            is_added |= ui.add_enabled(!self.text.trim().is_empty(), Button::new("Add note")).clicked();
        });
        let entry = entries.iter_mut().find(|entry| entry.number == self.of);
        if let Some(entry) = entry.filter(|_| is_added && !self.text.trim().is_empty()) {
            let text = std::mem::take(&mut self.text).trim().to_owned();
            entry.notes.push(Note { time_s: self.time_s - entry.shift_s, text });
            entry.notes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
            self.is_new = true;
        }
    }
}

/// All notes, by recording; times are those of the recording.
fn list(ui: &mut Ui, entries: &mut [Entry]) {
    if entries.iter().all(|entry| entry.notes.is_empty()) {
        let text = "No note yet. Notes are kept by File, Save session...; the recordings stay as they are.";
        ui.add(egui::Label::new(RichText::new(text).color(theme::weak(ui))).wrap());
        return;
    }
    Grid::new("notes").striped(true).show(ui, |ui| {
        heads(ui, &["time, s", "note", "recording", ""]);
        for entry in entries {
            let name = short(&entry.recording.about.name).to_owned();
            let mut dropped = None;
            for (index, note) in entry.notes.iter_mut().enumerate() {
                ui.add(DragValue::new(&mut note.time_s).speed(0.01).max_decimals(6));
                ui.add(TextEdit::singleline(&mut note.text).desired_width(200.0));
                ui.add(egui::Label::new(&name).truncate());
                if ui.small_button("x").on_hover_text("Removes the note").clicked() {
                    dropped = Some(index);
                }
                ui.end_row();
            }
            if let Some(index) = dropped {
                entry.notes.remove(index);
            }
        }
    });
}
