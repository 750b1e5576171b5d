//! The table of statistics of every channel that is drawn: of the visible range, or between the cursors.

use egui::{RichText, Ui};

use super::cursors::value;
use super::entry::swatch;
use super::{Drawing, Review};
use crate::recording::short;
use crate::samples::{Stats, stats};
use crate::table::{Column, Key, Table, number, text};
use crate::theme;

const COLUMNS: [Column; 11] = [
    text("", 16.0),
    text("recording", 170.0),
    text("channel", 140.0),
    text("unit", 56.0),
    number("samples", 76.0),
    number("mean", 84.0),
    number("std", 84.0),
    number("rms", 84.0),
    number("min", 84.0),
    number("max", 84.0),
    number("peak to peak", 90.0),
];

struct Row {
    colour: usize,
    texts: [String; 3],
    /// Number of samples, then the statistics.
    values: [Option<f64>; 7],
}

impl Row {
    fn count(&self) -> String {
        self.values[0].unwrap_or(0.0).to_string()
    }
}

impl Review {
    pub(super) fn statistics(&self, ui: &mut Ui, drawing: &Drawing<'_>) {
        let (range, what) = match self.cursors {
            Some([a, b]) if a != b => ([a.min(b), a.max(b)], "between the cursors"),
            _ => (drawing.x, "of the visible range"),
        };
        let rows = rows(drawing, range);
        ui.horizontal(|ui| {
            ui.label(RichText::new("Statistics").strong());
            let text = format!("{what}, {:.6} s .. {:.6} s", range[0], range[1]);
            ui.label(RichText::new(text).small().color(theme::weak(ui)));
            let lines = rows.iter().map(|row| {
                let values = row.values[1..].iter().map(|value| text_of(*value));
                row.texts.iter().cloned().chain([row.count()]).chain(values).collect()
            });
            copy_button(ui, &COLUMNS[1..], lines);
        });
        // A narrow tile is scrolled sideways.
        egui::ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
            ui.set_min_width(COLUMNS.iter().map(|column| column.width + 8.0).sum());
            Table::new("statistics", &COLUMNS).show(
                ui,
                &rows,
                |row, column| match column {
                    0 => Key::Number(row.colour as f64),
                    1..=3 => Key::from(row.texts[column - 1].as_str()),
                    _ => Key::from(row.values[column - 4]),
                },
                |ui, row, column| match column {
                    0 => swatch(ui, row.colour, &row.texts[0]),
                    1..=3 => drop(ui.label(&row.texts[column - 1])),
                    4 => drop(ui.label(RichText::new(row.count()).monospace())),
                    _ => value(ui, row.values[column - 4]),
                },
            );
        });
    }
}

fn rows(drawing: &Drawing<'_>, range: [f64; 2]) -> Vec<Row> {
    let mut rows = Vec::new();
    for signal in &drawing.drawn {
        for entry in drawing.entries.iter().filter(|entry| entry.shown) {
            let Some((samples, channel)) = entry.find(signal) else { continue };
            let stats = stats(samples, channel, range.map(|time| time - entry.shift_s));
            let of = |take: fn(&Stats) -> f64| stats.as_ref().map(take);
            let name = short(&entry.recording.about.name).to_owned();
            rows.push(Row {
                colour: entry.number,
                texts: [name, signal.name.clone(), signal.unit.clone()],
                values: [
                    of(|stats| stats.count as f64),
                    of(|stats| stats.mean),
                    of(|stats| stats.std),
                    of(|stats| stats.rms),
                    of(|stats| stats.min),
                    of(|stats| stats.max),
                    of(Stats::peak_to_peak),
                ],
            });
        }
    }
    rows
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
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        return format!("{value:.5e}");
    }
    let digits = (5.0 - value.abs().max(1e-4).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}
