//! The residuals of each channel as a table with bars, in units of the noise floor.

use egui::{RichText, Ui, vec2};
use socam_findings::Diagnosis;

use super::{colours, shown_in};
use crate::diagnosis::choice::Sides;
use socam_chart::numbers::significant;
use socam_chart::table::heads;
use socam_chart::theme;
use socam_workbench::display_units::{DisplayUnits, ShownIn};

/// Width of the columns beside that of the bars, points.
const COLUMNS: f32 = 430.0;

pub(super) fn fit(ui: &mut Ui, diagnosis: &Diagnosis, sides: Sides, units: &DisplayUnits) {
    ui.label(
        RichText::new(
            "Root mean square residuals. Bars: their ratios to the noise floor, logarithmic from 0.5 to 30; the line is at 1, which a perfect model reaches",
        )
        .small()
        .color(theme::weak(ui)),
    );
    let width = (ui.available_width() - COLUMNS).clamp(80.0, 300.0);
    let grid = egui::Grid::new("fit bars").striped(true).spacing([18.0, 6.0]);
    let rows = |ui: &mut Ui| {
        heads(ui, &["channel", "data", "residual / noise floor", "before", "after", "noise floor", "unit"]);
        for (name, fit) in &diagnosis.fit.channels {
            let ShownIn { unit, per_si } = shown_in(units, name, &fit.unit);
            let rows = [
                ("fitted", fit.rms_before, fit.rms_after),
                ("held out", fit.holdout_rms_before, fit.holdout_rms_after),
            ];
            for (data, before, after) in rows {
                ui.strong(if data == "fitted" { name.as_str() } else { "" });
                ui.label(data);
                bars(ui, width, ([before, after], fit.noise_std), sides);
                for value in [before, after, fit.noise_std] {
                    let text = value.map_or("-".into(), |value| significant(per_si * value, 3));
                    ui.label(RichText::new(text).monospace());
                }
                ui.label(&unit);
                ui.end_row();
            }
        }
    };
    egui::ScrollArea::horizontal().id_salt("fit").show(ui, |ui| grid.show(ui, rows));
}

/// Bars of both residuals on a logarithmic scale from 0.5 to 30 times the noise.
fn bars(ui: &mut Ui, width: f32, (values, noise_std): ([Option<f64>; 2], Option<f64>), sides: Sides) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, 20.0), egui::Sense::hover());
    let Some(noise) = noise_std.filter(|noise| *noise > 0.0) else { return };
    let painter = ui.painter_at(rect);
    let at = |ratio: f64| {
        rect.left() + rect.width() * ((ratio / 0.5).log10() / 60_f64.log10()).clamp(0.0, 1.0) as f32
    };
    let on = [sides != Sides::After, sides != Sides::Before];
    for (index, colour) in colours(ui).into_iter().enumerate() {
        let Some(value) = values[index].filter(|_| on[index]) else { continue };
        let top = rect.top() + 2.0 + 9.0 * index as f32;
        let bar =
            egui::Rect::from_min_max(egui::pos2(rect.left(), top), egui::pos2(at(value / noise), top + 7.0));
        painter.rect_filled(bar, 2.0, colour);
    }
    painter.vline(at(1.0), rect.y_range(), egui::Stroke::new(1.5, ui.visuals().strong_text_color()));
    let ratio = |value: Option<f64>| value.map_or("-".into(), |value| significant(value / noise, 3));
    response.on_hover_text(format!(
        "before {} x noise, after {} x noise",
        ratio(values[0]),
        ratio(values[1])
    ));
}
