//! The table of statistics of every channel that is drawn: of the visible range, or between the cursors.

use egui::{RichText, Ui};

use super::rows::{Row, copy_button, rows, text_of};
use super::{Drawing, Review};
use socam_chart::table::{Column, Table, number, text};
use socam_chart::theme;
use socam_samples::{Samples, Stats, stats};

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

/// The column of the number of samples, which has no decimals.
const COUNT: usize = 4;

/// Number of samples, then the statistics.
type StatisticsRow = Row<7>;

fn count(row: &StatisticsRow) -> String {
    row.values[0].unwrap_or(0.0).to_string()
}

impl Review {
    pub(super) fn statistics(&self, ui: &mut Ui, drawing: &Drawing<'_>) {
        let (range, what) = match self.between_cursors() {
            Some(range) => (range, "between the cursors"),
            None => (drawing.x, "of the visible range"),
        };
        let rows =
            rows(&drawing.drawn, (drawing.entries, &self.units), |samples, channel, shift_s, per_si| {
                statistics((samples, channel), range.map(|time| time - shift_s), per_si)
            });
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new("Statistics").strong());
            let text = format!("{what}, {:.6} s .. {:.6} s", range[0], range[1]);
            ui.label(RichText::new(text).small().color(theme::weak(ui)));
            let lines = rows.iter().map(|row| {
                let values = row.values[1..].iter().map(|value| text_of(*value));
                row.texts.iter().cloned().chain([count(row)]).chain(values).collect()
            });
            copy_button(ui, &COLUMNS[1..], lines);
        });
        // A narrow tile is scrolled sideways.
        egui::ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
            ui.set_min_width(COLUMNS.iter().map(|column| column.width + 8.0).sum());
            Table::new("statistics", &COLUMNS).show(ui, &rows, StatisticsRow::key, |ui, row, column| {
                if column == COUNT {
                    ui.label(RichText::new(count(row)).monospace());
                } else {
                    row.cell(ui, column);
                }
            });
        });
    }
}

fn statistics((samples, channel): (&Samples, usize), range: [f64; 2], per_si: f64) -> [Option<f64>; 7] {
    let stats = stats(samples, channel, range);
    let of = |take: fn(&Stats) -> f64| stats.as_ref().map(|stats| per_si * take(stats));
    [
        stats.as_ref().map(|stats| stats.count as f64),
        of(|stats| stats.mean),
        of(|stats| stats.std),
        of(|stats| stats.rms),
        of(|stats| stats.min),
        of(|stats| stats.max),
        of(Stats::peak_to_peak),
    ]
}
