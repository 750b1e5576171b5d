//! The table of channel values at the two cursors, with their differences.

use egui::{RichText, Ui};

use super::Review;
use super::list::neat;
use super::rows::{Row, copy_button, rows, text_of};
use socam_chart::table::{Column, Table, number, text};
use socam_workbench::entry::Entry;
use socam_workbench::signal::Signal;

const COLUMNS: [Column; 7] = [
    text("", 16.0),
    text("recording", 190.0),
    text("channel", 150.0),
    text("unit", 60.0),
    number("at A", 100.0),
    number("at B", 100.0),
    number("B - A", 100.0),
];

/// Draws the table below the charts, while there are cursors.
pub(super) fn panel(review: &Review, ui: &mut Ui, entries: &[Entry], signals: &[Signal]) {
    let Some(cursors) = review.cursors else { return };
    let panel = egui::Panel::bottom("cursors").default_size(176.0).resizable(true).size_range(60.0..=420.0);
    panel.show(ui, |ui| {
        let [a, b] = cursors;
        let rows = rows(
            &review.plots.drawn(signals),
            (entries, &review.units),
            |samples, channel, shift_s, per_si| {
                let at =
                    |time: f64| samples.value_at(channel, time - shift_s).map(|[_, value]| per_si * value);
                let (at_a, at_b) = (at(a), at(b));
                [at_a, at_b, at_a.zip(at_b).map(|(a, b)| b - a)]
            },
        );
        ui.horizontal(|ui| {
            ui.label(RichText::new(title(cursors)).strong());
            let lines =
                rows.iter().map(|row| row.texts.iter().cloned().chain(row.values.map(text_of)).collect());
            copy_button(ui, &COLUMNS[1..], lines);
        });
        // A narrow window is scrolled sideways.
        egui::ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
            ui.set_min_width(COLUMNS.iter().map(|column| column.width + 8.0).sum());
            Table::new("cursor values", &COLUMNS)
                .show(ui, &rows, Row::key, |ui, row, column| row.cell(ui, column));
        });
    });
}

fn title([a, b]: [f64; 2]) -> String {
    let frequency =
        if a == b { String::new() } else { format!("   1/(B - A) = {} Hz", neat(1.0 / (b - a).abs())) };
    format!("A = {a:.6} s   B = {b:.6} s   B - A = {:.6} s{frequency}", b - a)
}
