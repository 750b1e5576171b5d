//! The list of recordings and channels: the legend, with switches for what is shown.

use egui::{Button, DragValue, RichText, ScrollArea, Ui};

use super::Review;
use super::entry::{Entry, channels, swatch};
use crate::recording::short;
use crate::{layout, theme};

/// Draws the list. Returns the index of a recording that was closed.
pub(super) fn panel(review: &mut Review, ui: &mut Ui, entries: &mut [Entry]) -> Option<usize> {
    let mut closed = None;
    let width = layout::panel(ui, "recordings", 252.0);
    let panel = egui::Panel::left("recordings").default_size(width).size_range(170.0..=520.0);
    let panel = panel.show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.add_space(4.0);
            ui.label(RichText::new("Recordings").strong());
            if entries.is_empty() {
                ui.label(RichText::new("none open").color(theme::weak(ui)));
            }
            for (index, entry) in entries.iter_mut().enumerate() {
                if one(ui, index, entry) {
                    closed = Some(index);
                }
            }
            let all = channels(entries);
            if !all.is_empty() {
                ui.separator();
                ui.label(RichText::new("Channels").strong());
            }
            for channel in all {
                let column = channel.column_name();
                let mut on = !review.hidden.contains(&column);
                let text = format!("{}, {}", channel.name, channel.unit);
                if ui.add(egui::Checkbox::new(&mut on, RichText::new(text))).changed() {
                    if on {
                        review.hidden.remove(&column)
                    } else {
                        review.hidden.insert(column)
                    };
                }
            }
        });
    });
    layout::keep_panel(ui, "recordings", panel.response.rect.width());
    closed
}

/// One recording; true when it was closed.
fn one(ui: &mut Ui, index: usize, entry: &mut Entry) -> bool {
    let mut closed = false;
    let full_name = entry.recording.about.name.clone();
    let name = short(&full_name).to_owned();
    ui.push_id(index, |ui| {
        ui.horizontal(|ui| {
            swatch(ui, index, &name);
            let close = ui.add(Button::new("x").frame(false)).on_hover_text(format!("Close {name}"));
            close
                .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Close {name}")));
            closed = close.clicked();
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Truncate);
            ui.checkbox(&mut entry.shown, name.as_str()).on_hover_text(&full_name);
        });
        let text = facts(entry);
        let rows = entry.recording.samples.rows();
        let rows = if rows == 1 { "1 sample".to_owned() } else { format!("{} samples", grouped(rows)) };
        ui.horizontal(|ui| {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let shift = DragValue::new(&mut entry.shift_s).speed(0.001).suffix(" s").max_decimals(6);
                let shift = ui.scope(|ui| {
                    ui.style_mut().override_text_style = Some(egui::TextStyle::Small);
                    ui.spacing_mut().button_padding = egui::vec2(5.0, 1.0);
                    ui.spacing_mut().interact_size.y = 16.0;
                    ui.add(shift)
                });
                let said = format!("shift of {name}");
                shift.inner.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, &said));
                shift.inner.on_hover_text("Draws this recording later or earlier, to lay it over another");
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    ui.add(egui::Label::new(RichText::new(&text).small().color(theme::weak(ui))).truncate())
                        .on_hover_text(format!("{rows}, {text}"));
                });
            });
        });
        for warning in &entry.recording.about.warnings {
            ui.label(RichText::new(warning).small().color(theme::alarm(ui)));
        }
        let notes = entry.recording.about.facts.iter().filter(|(name, _)| name == "note");
        for (_, note) in notes {
            ui.label(RichText::new(format!("note: {note}")).small());
        }
    });
    ui.add_space(4.0);
    closed
}

fn facts(entry: &Entry) -> String {
    let samples = &entry.recording.samples;
    let span_s = samples.span_s().map_or(0.0, |[from, to]| to - from);
    let step_s = entry.recording.about.sample_time_s;
    let rate = if step_s > 0.0 { format!(" at {} Hz", neat(1.0 / step_s)) } else { String::new() };
    let gaps = samples.segments().len().saturating_sub(1);
    let gaps = match gaps {
        0 => String::new(),
        1 => ", 1 gap".into(),
        more => format!(", {more} gaps"),
    };
    format!("{} s{rate}{gaps}", neat(span_s))
}

/// Four digits, without zeros at the end.
pub(crate) fn neat(value: f64) -> String {
    let digits = (3.0 - value.abs().max(1e-12).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// `1 234 567`
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let groups: Vec<&[u8]> = digits.as_bytes().rchunks(3).rev().collect();
    let texts = groups.iter().map(|group| String::from_utf8_lossy(group).into_owned());
    texts.collect::<Vec<_>>().join(" ")
}
