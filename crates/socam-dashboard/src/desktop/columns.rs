//! The window in which the columns of a file get names and units: guesses are shown as guesses, and taken only by a click.

use std::path::{Path, PathBuf};

use egui::{
    Button, Checkbox, ComboBox, DragValue, Label, RichText, Role, ScrollArea, TextEdit, Ui, WidgetInfo,
};
use socam_chart::numbers::number;
use socam_chart::table::{self, Key, Table};
use socam_chart::theme;
use socam_import::{ClockChoice, ColumnChoice, Columns};

use super::foreign::mapping_of;
use crate::layout;

const HEADS: [table::Column; 5] = [
    table::text("column", 170.0),
    table::text("channel", 150.0),
    table::text("unit", 80.0),
    table::text("guess", 130.0),
    table::text("numbers in the file", 150.0),
];

/// Units of times.
const TIME_UNITS: [&str; 6] = ["s", "ms", "us", "ns", "min", "h"];

/// The window for one file.
#[derive(Debug)]
pub(super) struct Pane {
    columns: Columns,
    /// The name that the file was opened by.
    pub(super) run: String,
    problem: Option<String>,
}

/// What was done in the window.
pub(super) enum Answer {
    /// The mapping was written: the recording is to be opened again.
    Written,
    /// The window was closed.
    Closed,
}

impl Pane {
    /// # Errors
    /// When the file cannot be read; one sentence.
    pub(super) fn of(path: &Path, run: &str) -> Result<Self, String> {
        let columns = Columns::of(path).map_err(|error| error.to_string())?;
        Ok(Self { columns, run: run.to_owned(), problem: None })
    }

    /// Draws it; `Some` when it ended.
    pub(super) fn ui(&mut self, ctx: &egui::Context) -> Option<Answer> {
        let (mut open, mut written) = (true, false);
        let free = layout::free(ctx).shrink(4.0);
        let title = format!("Columns of {}", socam_workbench::recording::short(&self.run));
        let window = egui::Window::new(title).open(&mut open).collapsible(false).constrain_to(free);
        let window = window.default_size([760.0, 460.0]).max_size(free.size() - egui::vec2(16.0, 48.0));
        window.show(ctx, |ui| {
            let text = "The file does not state all units. A column without one is drawn as plain numbers; fits need units.";
            ui.add(Label::new(RichText::new(text).color(theme::weak(ui))).wrap());
            let signals: Vec<String> = self.columns.columns.iter().map(|own| own.signal.clone()).collect();
            for (number, clock) in self.columns.clocks.iter_mut().enumerate() {
                self::clock(ui, number, clock, &signals);
                if let Some(why) = clock.restarts.as_ref().filter(|_| clock.time.is_none()) {
                    let text = format!("{why}: write each part as a file of its own, or state the rate here. What happens between two parts is then taken for a motion.");
                    ui.add(Label::new(RichText::new(text).color(theme::alarm(ui))).wrap());
                }
            }
            let height = (ui.available_height() - 64.0).max(90.0);
            ScrollArea::horizontal().max_height(height).show(ui, |ui| rows(ui, &mut self.columns.columns, height));
            ui.horizontal_wrapped(|ui| written = self.buttons(ui));
            if let Some(problem) = &self.problem {
                ui.add(Label::new(RichText::new(problem).color(theme::alarm(ui))).wrap());
            }
        });
        match (written, open) {
            (true, _) => Some(Answer::Written),
            (_, false) => Some(Answer::Closed),
            _ => None,
        }
    }

    /// Whether the mapping was written.
    fn buttons(&mut self, ui: &mut Ui) -> bool {
        let guesses = self.columns.columns.iter().filter(|own| own.unit.is_empty() && own.guess.is_some());
        let take = Button::new(format!("Take all guesses ({})", guesses.clone().count()));
        if ui.add_enabled(guesses.count() > 0, take).clicked() {
            self.columns.columns.iter_mut().for_each(take_guess);
        }
        let place = mapping_of(&self.columns.path);
        let is_wanted = ui
            .button(RichText::new("Open with these").strong())
            .on_hover_text(format!("Writes {}, by which the file is read from now on", place.display()))
            .clicked();
        if !is_wanted {
            return false;
        }
        let text = self.columns.mapping().map(|_| self.columns.text());
        let done = text.and_then(|text| socam_workbench::save::write_new(&place, text.as_bytes()));
        self.problem = done.err();
        // The index of a long file holds its columns as they were.
        if self.problem.is_none()
            && let Some(index) = socam_samples::index::path_of(&self.columns.path)
        {
            let _ = std::fs::remove_file(index);
        }
        self.problem.is_none()
    }

    /// The file.
    pub(super) fn path(&self) -> PathBuf {
        self.columns.path.clone()
    }
}

fn take_guess(own: &mut ColumnChoice) {
    if let Some(guess) = own.guess.as_ref().filter(|_| own.unit.is_empty()) {
        own.unit.clone_from(guess);
    }
}

/// The signal with the times and its unit, or a rate.
fn clock(ui: &mut Ui, number: usize, clock: &mut ClockChoice, signals: &[String]) {
    ui.horizontal_wrapped(|ui| {
        let name =
            if clock.group.is_empty() { "Time".to_owned() } else { format!("Time of {}", clock.group) };
        let label = ui.label(name);
        let shown = clock.time.clone().unwrap_or_else(|| "rows at an even rate".into());
        let own = clock.time.clone();
        let choice = ComboBox::from_id_salt(("clock", number)).selected_text(shown).width(190.0).truncate();
        let choice = choice.show_ui(ui, |ui| {
            ui.selectable_value(&mut clock.time, None, "rows at an even rate");
            for signal in own.iter().chain(signals) {
                ui.selectable_value(&mut clock.time, Some(signal.clone()), signal);
            }
        });
        choice.response.labelled_by(label.id);
        if clock.time.is_none() {
            let field = DragValue::new(&mut clock.rate_hz).range(1e-3..=1e6).suffix(" Hz");
            ui.add(field).labelled_by(label.id).on_hover_text("1 Hz numbers the rows");
        } else {
            let unit =
                ComboBox::from_id_salt(("unit of clock", number)).selected_text(&clock.unit).width(60.0);
            let unit = unit.show_ui(ui, |ui| {
                for unit in TIME_UNITS {
                    ui.selectable_value(&mut clock.unit, unit.to_owned(), unit);
                }
            });
            unit.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, "Unit of the time"));
            if !clock.is_stated {
                ui.label(RichText::new("guessed").italics().color(theme::weak(ui)));
            }
        }
    });
}

fn rows(ui: &mut Ui, columns: &mut [ColumnChoice], height: f32) {
    let places: Vec<usize> = (0..columns.len()).collect();
    let mut table = Table::new("columns of a file", &HEADS);
    table.most_height = height;
    let keys: Vec<[String; 4]> = columns
        .iter()
        .map(|own| {
            [own.signal.clone(), own.name.clone(), own.unit.clone(), own.guess.clone().unwrap_or_default()]
        })
        .collect();
    let key = |place: &usize, column: usize| match keys[*place].get(column) {
        Some(text) => Key::from(text.as_str()),
        None => Key::Missing,
    };
    table.show(ui, &places, key, |ui, place, column| cell(ui, &mut columns[*place], column));
}

fn cell(ui: &mut Ui, own: &mut ColumnChoice, column: usize) {
    let signal = own.signal.clone();
    match column {
        0 => {
            let tick = ui.add(Checkbox::new(&mut own.is_used, &signal));
            tick.on_hover_text("Whether it becomes a channel");
        }
        1 => {
            let field =
                ui.add_enabled(own.is_used, TextEdit::singleline(&mut own.name).desired_width(f32::INFINITY));
            field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, format!("Channel of {signal}")));
        }
        2 => {
            let field = TextEdit::singleline(&mut own.unit).hint_text("none").desired_width(f32::INFINITY);
            let field = ui.add_enabled(own.is_used, field);
            field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, format!("Unit of {signal}")));
        }
        3 => match own.guess.clone().filter(|_| own.unit.is_empty()) {
            Some(guess) => {
                let button =
                    ui.add_enabled(own.is_used, Button::new(RichText::new(format!("{guess}?")).italics()));
                button.widget_info(|| {
                    WidgetInfo::labeled(Role::Button, true, format!("Take {guess} for {signal}"))
                });
                if button.on_hover_text(&own.evidence).clicked() {
                    take_guess(own);
                }
            }
            None => drop(ui.label(
                RichText::new(if own.unit.is_empty() { "unknown" } else { "" }).color(theme::weak(ui)),
            )),
        },
        _ => {
            let text = own
                .range
                .map_or_else(String::new, |(low, high)| format!("{} to {}", number(low), number(high)));
            ui.label(RichText::new(text).color(theme::weak(ui)));
        }
    }
}
