//! The table of channel values at the two cursors, with their differences.

use egui::{RichText, Ui};

use super::Review;
use super::entry::{Entry, swatch};
use super::list::neat;
use super::signal::Signal;
use super::statistics::{copy_button, text_of};
use crate::recording::short;
use crate::table::{Column, Key, Table, number, text};
use crate::theme;

const COLUMNS: [Column; 7] = [
    text("", 16.0),
    text("recording", 190.0),
    text("channel", 150.0),
    text("unit", 60.0),
    number("at A", 100.0),
    number("at B", 100.0),
    number("B - A", 100.0),
];

/// A channel of a recording at the cursors.
struct Row {
    colour: usize,
    texts: [String; 3],
    values: [Option<f64>; 3],
}

/// Draws the table below the charts, while there are cursors.
pub(super) fn panel(review: &Review, ui: &mut Ui, entries: &[Entry], signals: &[Signal]) {
    let Some(cursors) = review.cursors else { return };
    let panel = egui::Panel::bottom("cursors").default_size(176.0).resizable(true).size_range(60.0..=420.0);
    panel.show(ui, |ui| {
        let rows = rows(&review.plots.drawn(signals), entries, cursors);
        ui.horizontal(|ui| {
            ui.label(RichText::new(title(cursors)).strong());
            let lines =
                rows.iter().map(|row| row.texts.iter().cloned().chain(row.values.map(text_of)).collect());
            copy_button(ui, &COLUMNS[1..], lines);
        });
        Table::new("cursor values", &COLUMNS).show(
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
                _ => value(ui, row.values[column - 4]),
            },
        );
    });
}

fn rows(signals: &[Signal], entries: &[Entry], [a, b]: [f64; 2]) -> Vec<Row> {
    let mut rows = Vec::new();
    for signal in signals {
        for entry in entries.iter().filter(|entry| entry.shown) {
            let Some((samples, channel)) = entry.find(signal) else { continue };
            let at = |time: f64| samples.value_at(channel, time - entry.shift_s).map(|[_, value]| value);
            let (at_a, at_b) = (at(a), at(b));
            let name = short(&entry.recording.about.name).to_owned();
            rows.push(Row {
                colour: entry.number,
                texts: [name, signal.name.clone(), signal.unit.clone()],
                values: [at_a, at_b, at_a.zip(at_b).map(|(a, b)| b - a)],
            });
        }
    }
    rows
}

fn title([a, b]: [f64; 2]) -> String {
    let frequency =
        if a == b { String::new() } else { format!("   1/(B - A) = {} Hz", neat(1.0 / (b - a).abs())) };
    format!("A = {a:.6} s   B = {b:.6} s   B - A = {:.6} s{frequency}", b - a)
}

/// A number of a table.
pub(super) fn value(ui: &mut Ui, value: Option<f64>) {
    let text = RichText::new(text_of(value)).monospace();
    ui.label(if value.is_some() { text } else { text.color(theme::weak(ui)) });
}
