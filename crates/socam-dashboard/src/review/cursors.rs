//! The table of channel values at the two cursors, with their differences.

use egui::{Grid, RichText, ScrollArea, Ui};

use super::Review;
use super::entry::{Entry, channels, swatch};
use super::list::neat;
use crate::recording::short;
use crate::theme;

/// Draws the table below the charts, while there are cursors.
pub(super) fn panel(review: &mut Review, ui: &mut Ui, entries: &[Entry]) {
    let Some([a, b]) = review.cursors else { return };
    egui::Panel::bottom("cursors").default_size(170.0).resizable(true).size_range(60.0..=420.0).show(
        ui,
        |ui| {
            let frequency = if a == b {
                String::new()
            } else {
                format!("   1/(B - A) = {} Hz", neat(1.0 / (b - a).abs()))
            };
            ui.label(
                RichText::new(format!(
                    "A = {} s   B = {} s   B - A = {} s{frequency}",
                    time(a),
                    time(b),
                    time(b - a)
                ))
                .strong(),
            );
            ScrollArea::both().auto_shrink(false).show(ui, |ui| {
                Grid::new("cursor values").striped(true).num_columns(7).spacing([18.0, 3.0]).show(ui, |ui| {
                    for head in ["", "recording", "channel", "unit", "at A", "at B", "B - A"] {
                        ui.label(RichText::new(head).small().color(theme::weak(ui)));
                    }
                    ui.end_row();
                    for channel in channels(entries) {
                        if review.hidden.contains(&channel.column_name()) {
                            continue;
                        }
                        for (number, entry) in entries.iter().enumerate().filter(|(_, entry)| entry.shown) {
                            let recording = &entry.recording;
                            let Some(index) = recording.about.channels.iter().position(|own| *own == channel)
                            else {
                                continue;
                            };
                            let at = |time: f64| {
                                recording
                                    .samples
                                    .value_at(index, time - entry.shift_s)
                                    .map(|[_, value]| value)
                            };
                            let (at_a, at_b) = (at(a), at(b));
                            let name = short(&recording.about.name);
                            swatch(ui, number, name);
                            ui.label(name);
                            ui.label(&channel.name);
                            ui.label(channel.unit.symbol());
                            for value in [at_a, at_b, at_a.zip(at_b).map(|(a, b)| b - a)] {
                                let text = value.map_or("no sample".to_owned(), value_text);
                                ui.label(RichText::new(text).monospace());
                            }
                            ui.end_row();
                        }
                    }
                });
            });
        },
    );
}

fn time(value: f64) -> String {
    format!("{value:.6}")
}

/// Six digits.
fn value_text(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        return format!("{value:.5e}");
    }
    let digits = (5.0 - value.abs().max(1e-4).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}
