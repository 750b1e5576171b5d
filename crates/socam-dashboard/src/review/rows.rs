//! Tables of numbers of every channel that is drawn, of every recording that is shown: at the cursors, and statistics.

use egui::{RichText, Ui};

use socam_chart::swatch::swatch;
use socam_chart::table::{Column, Key};
use socam_chart::theme;
use socam_samples::Samples;
use socam_workbench::display_units::DisplayUnits;
use socam_workbench::entry::Entry;
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;

/// Columns before the numbers: the colour, and [`Row::texts`].
const FIRST: usize = 4;

/// A channel of a recording, and its numbers.
pub(super) struct Row<const N: usize> {
    colour: usize,
    /// Recording, channel, unit.
    pub(super) texts: [String; 3],
    pub(super) values: [Option<f64>; N],
}

/// A row for each signal of each recording that has it; `values` takes its samples, its channel, the delay of its times, s, and the
/// factor from SI to the unit in which it is shown.
pub(super) fn rows<const N: usize>(
    signals: &[Signal],
    (entries, units): (&[Entry], &DisplayUnits),
    values: impl Fn(&Samples, usize, f64, f64) -> [Option<f64>; N],
) -> Vec<Row<N>> {
    let mut rows = Vec::new();
    for signal in signals {
        let shown = units.of(signal);
        for entry in entries.iter().filter(|entry| entry.shown) {
            let Some((samples, channel)) = entry.find(signal) else { continue };
            let name = short(&entry.recording.about.name).to_owned();
            rows.push(Row {
                colour: entry.number,
                texts: [name, signal.name.clone(), shown.unit.clone()],
                values: values(samples, channel, entry.shift_s, shown.per_si),
            });
        }
    }
    rows
}

impl<const N: usize> Row<N> {
    /// Key by which a column is sorted.
    pub(super) fn key(&self, column: usize) -> Key {
        match column {
            0 => Key::Number(self.colour as f64),
            1..FIRST => Key::from(self.texts[column - 1].as_str()),
            _ => Key::from(self.values[column - FIRST]),
        }
    }

    /// Draws a cell.
    pub(super) fn cell(&self, ui: &mut Ui, column: usize) {
        match column {
            0 => swatch(ui, self.colour, &self.texts[0]),
            1..FIRST => drop(ui.label(&self.texts[column - 1])),
            _ => value(ui, self.values[column - FIRST]),
        }
    }
}

fn value(ui: &mut Ui, value: Option<f64>) {
    let text = RichText::new(text_of(value)).monospace();
    ui.label(if value.is_some() { text } else { text.color(theme::weak(ui)) });
}

/// A button that copies a table as lines of cells separated by tabs, as spreadsheets take them.
pub(super) fn copy_button(ui: &mut Ui, columns: &[Column], lines: impl Iterator<Item = Vec<String>>) {
    if ui.small_button("Copy table").on_hover_text("As text with tabs, for a spreadsheet").clicked() {
        let heads = columns.iter().map(|column| column.head.to_owned()).collect();
        let lines = std::iter::once(heads).chain(lines).map(|line: Vec<String>| line.join("\t"));
        ui.ctx().copy_text(lines.collect::<Vec<_>>().join("\n") + "\n");
    }
}

/// Six digits.
pub(super) fn text_of(value: Option<f64>) -> String {
    let Some(value) = value else { return "no sample".into() };
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.5e}");
    }
    let digits = (5.0 - value.abs().max(1e-3).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}
