//! The row above the plots, and the actions of its menus.

use egui::{Button, Key, RichText, TextStyle, Ui};

use super::notes::Notes;
use super::plots::Plots;
use super::{Entry, Review, Signal, Views};
use crate::together::keep;
use socam_chart::theme;
use socam_workbench::arrangement::Plot;
use socam_workbench::purpose::Purpose;
use socam_workbench::recording::short;
use socam_workbench::{Content, Request};

/// Action of a menu.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    Xy,
    Spectrogram,
    Statistics,
    Histogram,
    Table,
    Derive,
    Note,
    Even,
    Usual,
    Save,
}

impl Action {
    pub(super) const ALL: [Self; 10] = [
        Self::Xy,
        Self::Spectrogram,
        Self::Statistics,
        Self::Histogram,
        Self::Table,
        Self::Derive,
        Self::Note,
        Self::Even,
        Self::Usual,
        Self::Save,
    ];
    /// How many of [`Self::ALL`], the first ones, are those of the menu Add.
    const ADDED: usize = 7;

    fn name(self) -> &'static str {
        match self {
            Self::Xy => "XY plot",
            Self::Spectrogram => "Spectrogram",
            Self::Statistics => "Statistics",
            Self::Histogram => "Histogram",
            Self::Table => "Table of values",
            Self::Derive => "Derived channel...",
            Self::Note => "Note...",
            Self::Even => "Equal heights",
            Self::Usual => "One plot per channel",
            Self::Save => "Save layout...",
        }
    }

    fn tip(self) -> &'static str {
        match self {
            Self::Xy => "A channel over another, coloured by time",
            Self::Spectrogram => "The spectra of a channel over time",
            Self::Statistics => {
                "A table: mean, standard deviation and so on of what is visible, or between A and B"
            }
            Self::Histogram => "How often values of a channel occur in the range in sight",
            Self::Table => "The rows in sight of one recording, all channels",
            Self::Derive => "Formulas with units, derivative, integral, difference, ratio, product, filters",
            Self::Note => "A note on a moment of a recording: cursor A, else where the pointer was",
            Self::Even => "All plots of a column get the same height",
            Self::Usual => "Forgets the arrangement, and shows all channels",
            Self::Save => "Plots and derived channels as a file; open it like a recording (Ctrl+O)",
        }
    }

    pub(super) fn key(self) -> Option<Key> {
        match self {
            Self::Xy => Some(Key::X),
            Self::Spectrogram => Some(Key::G),
            Self::Statistics => Some(Key::T),
            Self::Histogram => Some(Key::H),
            Self::Table => Some(Key::V),
            Self::Derive => Some(Key::D),
            Self::Note => Some(Key::N),
            Self::Even => Some(Key::E),
            Self::Usual | Self::Save => None,
        }
    }

    fn item(self, ui: &mut Ui) -> Option<Self> {
        let mut button = Button::new(self.name());
        if let Some(key) = self.key() {
            button = button.shortcut_text(key.name());
        }
        let response = ui.add(button);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, self.name()));
        response.on_hover_text(self.tip()).clicked().then_some(self)
    }
}

/// What the mouse does, where the row has room for it.
fn hint(ui: &mut Ui) {
    let text = "drag: pan   wheel: zoom   Shift+wheel: scroll   right-drag: zoom to box";
    let font = TextStyle::Small.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, theme::weak(ui));
    if galley.size().x < ui.available_size_before_wrap().x {
        ui.label(RichText::new(text).small().color(theme::weak(ui)));
    }
}

impl Review {
    pub(super) fn toolbar(
        &mut self,
        ui: &mut Ui,
        entries: &mut Vec<Entry>,
        signals: &[Signal],
    ) -> Option<Request> {
        let (mut action, mut wanted) = (None, None);
        ui.horizontal_wrapped(|ui| {
            if ui.button("Fit all").on_hover_text("Show everything (Home, or double-click a chart)").clicked()
            {
                self.fit();
            }
            self.cursor_buttons(ui, entries);
            if entries.iter().any(|entry| !entry.recording.about.events.is_empty() || !entry.notes.is_empty())
            {
                let mut shows = !self.hides_events;
                let button = ui.toggle_value(&mut shows, "Events");
                button.on_hover_text("Marks of notes, stops, faults and parts of the profile");
                self.hides_events = !shows;
            }
            ui.menu_button("Add", |ui| {
                action = Action::ALL.into_iter().take(Action::ADDED).find_map(|own| own.item(ui)).or(action);
            });
            ui.menu_button("Layout", |ui| {
                let actions = [Action::Usual, Action::Even, Action::Save];
                action = actions.into_iter().find_map(|own| own.item(ui)).or(action);
                ui.separator();
                let [undo, redo] = self.views.can();
                let button = |name, keys| Button::new(name).shortcut_text(keys);
                if ui.add_enabled(undo, button("Undo change of view", "Ctrl+Z")).clicked() {
                    self.undo_last(entries);
                }
                if ui.add_enabled(redo, button("Redo change of view", "Ctrl+Y")).clicked() {
                    self.step(entries, Views::redo);
                }
            });
            if entries.len() > 1 {
                ui.separator();
                self.choose_reference(ui, entries);
            }
            super::units::menu(ui, &mut self.units, signals);
            if super::clock::is_known(entries) {
                let button = ui.toggle_value(&mut self.clock_time, "Time of day");
                button.on_hover_text("Times of day on the time axis, as the recording states them");
            }
            wanted = self.fit_button(ui);
            hint(ui);
        });
        wanted.or_else(|| self.act(action?, signals))
    }

    fn cursor_buttons(&mut self, ui: &mut Ui, entries: &[Entry]) {
        let mut on = self.cursors.is_some();
        let button = ui.toggle_value(&mut on, "Cursors A, B");
        if button.on_hover_text("Click a chart to set A, then B (C)").clicked() {
            self.toggle_cursors(entries);
        }
        if self.cursors.is_some()
            && ui.button("Zoom to A..B").on_hover_text("Show what is between the cursors (Z)").clicked()
        {
            self.zoom_to_cursors();
        }
    }

    /// The range between the cursors, where they are apart.
    pub(super) fn between_cursors(&self) -> Option<[f64; 2]> {
        self.cursors.filter(|[a, b]| a != b).map(|[a, b]| [a.min(b), a.max(b)])
    }

    /// Asks for a fit of a part of the recordings, where a part is chosen.
    fn fit_button(&self, ui: &mut Ui) -> Option<Request> {
        let between = self.between_cursors();
        let [from, to] = between.or(self.x).filter(|_| self.can_fit)?;
        let what = if between.is_some() { "between the cursors" } else { "in sight" };
        let button = ui.button("Fit this range").on_hover_text(format!(
            "Identify and Diagnosis read what is {what} of each recording, {from:.6} s to {to:.6} s"
        ));
        button.clicked().then_some(Request::FitRange([from, to]))
    }

    fn choose_reference(&mut self, ui: &mut Ui, entries: &[Entry]) {
        keep(ui, "Difference to", 158.0);
        let label = ui.label("Difference to");
        let name = |index: Option<usize>| {
            index.and_then(|i| entries.get(i)).map_or("none", |entry| short(&entry.recording.about.name))
        };
        let chosen =
            egui::ComboBox::from_id_salt("reference").selected_text(name(self.reference)).width(150.0);
        let chosen = chosen.show_ui(ui, |ui| {
            ui.selectable_value(&mut self.reference, None, "none");
            for index in 0..entries.len() {
                ui.selectable_value(&mut self.reference, Some(index), name(Some(index)));
            }
        });
        chosen.response.labelled_by(label.id);
    }

    pub(super) fn act(&mut self, action: Action, signals: &[Signal]) -> Option<Request> {
        let drawn = self.plots.drawn(signals);
        let first = drawn.first().or(signals.first())?.clone();
        match action {
            Action::Xy => {
                let y = drawn.last().unwrap_or(&first).clone();
                self.add(Plot::Xy { y, x: first });
            }
            Action::Spectrogram => self.add(Plot::Spectrogram(first)),
            Action::Statistics => {
                let known = self.plots.panes().find(|(_, plot)| matches!(plot, Plot::Statistics));
                match known.map(|(id, _)| id) {
                    Some(id) => self.plots.close(id),
                    None => self.add(Plot::Statistics),
                }
            }
            Action::Histogram => self.add(Plot::Histogram(first)),
            Action::Table => self.add(Plot::Table),
            Action::Derive => self.ask_for_channel(&first.name),
            Action::Note => {
                let cursor = self.cursors.map(|[a, _]| a);
                let centre = self.x.map_or(0.0, |[from, to]| 0.5 * (from + to));
                self.notes = Some(Notes::at(cursor.or(self.linked.at()).unwrap_or(centre)));
            }
            Action::Even => self.plots.even = true,
            Action::Usual => self.plots = Plots::default(),
            Action::Save => {
                let text = self.arrangement().text();
                return Some(Request::SaveAs(
                    Purpose::SavePlots,
                    "plots.layout.json".into(),
                    Content::Bytes(text.into_bytes()),
                ));
            }
        }
        None
    }
}
