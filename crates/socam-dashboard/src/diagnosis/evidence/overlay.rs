//! The first picture: measured against predicted of the channel that the correction improves most, before and after.

use egui::{RichText, Ui, vec2};
use socam_findings::document::Overlay;

use super::colours;
use crate::diagnosis::choice::Sides;
use socam_chart::chart::{Chart, Curve, Seen, Style, range_of, with_room};
use socam_chart::theme;
use socam_chart::thin::thinned;
use socam_workbench::recording::short;

/// Share of the height that the signals take; the residuals take the rest.
const SIGNALS: f32 = 0.64;
/// Height above which the residuals are drawn too, points.
const ROOM: f32 = 260.0;

pub(super) fn ui(ui: &mut Ui, overlay: &Overlay, sides: Sides, seen: &mut Vec<Seen>) {
    let height = ui.available_height().max(140.0);
    let has_room = height > ROOM;
    let share = if has_room { SIGNALS } else { 1.0 };
    let [before, after] = colours(ui);
    let kind = if overlay.held_out { "held out" } else { "fitted" };
    let signals = [
        ("measured", theme::weak(ui), &overlay.measured, true),
        ("before", before, &overlay.before, sides != Sides::After),
        ("after", after, &overlay.after, sides != Sides::Before),
    ];
    let title = format!(
        "{}: measured and predicted, {} ({}, {kind})",
        overlay.channel,
        overlay.unit,
        short(&overlay.recording)
    );
    let has_after = !overlay.after.is_empty();
    ui.horizontal(|ui| {
        for (_, text, colour) in [
            (true, "measured", theme::weak(ui)),
            (
                sides != Sides::After,
                if has_after { "predicted before" } else { "predicted by the model" },
                before,
            ),
            (sides != Sides::Before && has_after, "predicted after", after),
        ]
        .into_iter()
        .filter(|(is_drawn, ..)| *is_drawn)
        {
            ui.label(RichText::new(text).small().strong().color(colour));
        }
    });
    let height = ui.available_height().max(140.0);
    let spacing = ui.spacing().item_spacing.y;
    let mut chart = chart(ui, "overlay", title, share * height - spacing, overlay, &signals);
    if !has_room {
        chart.x_label = "time, s".into();
    }
    chart.show(ui, seen);
    if has_room {
        let residuals = [
            ("before", before, &overlay.residual_before, sides != Sides::After),
            ("after", after, &overlay.residual_after, sides != Sides::Before),
        ];
        let title = format!("{}: measured minus predicted, {}", overlay.channel, overlay.unit);
        let mut chart =
            self::chart(ui, "overlay residual", title, (1.0 - share) * height, overlay, &residuals);
        chart.x_label = "time, s".into();
        chart.show(ui, seen);
    }
}

/// Name, colour and values of a line, and whether it is drawn.
type Line<'a> = (&'a str, egui::Color32, &'a Vec<Option<f64>>, bool);

fn chart(ui: &Ui, id: &str, title: String, height: f32, overlay: &Overlay, lines: &[Line<'_>]) -> Chart {
    let mut chart = Chart::new(id, title, vec2(ui.available_width(), height));
    chart.x = range_of(overlay.time_s.iter().copied()).map_or([0.0, 1.0], with_room);
    for (name, colour, values, _) in
        lines.iter().filter(|(_, _, values, is_drawn)| *is_drawn && !values.is_empty())
    {
        let points: Vec<[f64; 2]> =
            overlay.time_s.iter().zip(*values).map(|(t, value)| [*t, value.unwrap_or(f64::NAN)]).collect();
        let parts = thinned(&points, usize::MAX / 4);
        chart.curves.push(Curve { name: (*name).into(), colour: *colour, parts, style: Style::Solid });
    }
    let values = chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
    chart.y = chart.fitted(range_of(values));
    chart
}
