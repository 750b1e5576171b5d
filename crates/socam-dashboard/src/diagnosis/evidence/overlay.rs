//! The first picture: measured against predicted of the channel that the correction improves most, before and after.

use egui::{Ui, vec2};
use socam_findings::document::Overlay;

use super::{colours, shown_in};
use crate::diagnosis::choice::Sides;
use socam_chart::beside::{self, measured, predicted, predicted_before};
use socam_chart::chart::{Chart, Curve, Seen, Style, range_of, with_room};
use socam_chart::thin::thinned;
use socam_workbench::display_units::{DisplayUnits, ShownIn};
use socam_workbench::recording::short;

/// Share of the height that the signals take; the residuals take the rest.
const SIGNALS: f32 = 0.64;
/// Height above which the residuals are drawn too, points.
const ROOM: f32 = 260.0;

pub(super) fn ui(ui: &mut Ui, overlay: &Overlay, sides: Sides, units: &DisplayUnits, seen: &mut Vec<Seen>) {
    let ShownIn { unit, per_si } = shown_in(units, &overlay.channel, &overlay.unit);
    legend(ui, overlay, sides);
    let height = ui.available_height();
    let has_room = height > ROOM;
    let share = if has_room { SIGNALS } else { 1.0 };
    let [before, after] = line_colours(ui, overlay);
    let [has_before, has_after] = [sides != Sides::After, sides != Sides::Before];
    let kind = if overlay.held_out { "held out" } else { "fitted" };
    let title = format!(
        "{}: measured and predicted, {unit} ({}, {kind})",
        overlay.channel,
        short(&overlay.recording)
    );
    let spacing = ui.spacing().item_spacing.y;
    let line = |values: &[Option<f64>], is_drawn: bool| {
        if is_drawn { parts(overlay, values, per_si) } else { Vec::new() }
    };
    let mut signals = chart(ui, "overlay", title, share * height - spacing, overlay);
    signals.curves = vec![
        predicted_before("before", before, line(&overlay.before, has_before)),
        predicted("after", after, line(&overlay.after, has_after)),
        measured(ui, line(&overlay.measured, true)),
    ];
    if !has_room {
        signals.x_label = "time, s".into();
    }
    fit(&mut signals);
    signals.show(ui, seen);
    if has_room {
        let title = format!("{}: measured minus predicted, {unit}", overlay.channel);
        let mut residuals = chart(ui, "overlay residual", title, (1.0 - share) * height, overlay);
        residuals.x_label = "time, s".into();
        residuals.curves = vec![
            residual("before", before, line(&overlay.residual_before, has_before)),
            residual("after", after, line(&overlay.residual_after, has_after)),
        ];
        fit(&mut residuals);
        residuals.show(ui, seen);
    }
}

/// Colours of the predictions before and after. A model to which nothing was added is not drawn in the colour of an alarm.
fn line_colours(ui: &Ui, overlay: &Overlay) -> [egui::Color32; 2] {
    let [before, after] = colours(ui);
    if overlay.after.is_empty() { [after, after] } else { [before, after] }
}

fn legend(ui: &mut Ui, overlay: &Overlay, sides: Sides) {
    let [before, after] = line_colours(ui, overlay);
    let has_after = !overlay.after.is_empty();
    ui.horizontal_wrapped(|ui| {
        beside::legend(ui, "measured", beside::ink(ui), Style::Thin);
        if sides != Sides::After {
            let name = if has_after { "predicted before" } else { "predicted by the model" };
            beside::legend(ui, name, before, Style::Wide);
        }
        if sides != Sides::Before && has_after {
            beside::legend(ui, "predicted after", after, Style::Broad);
        }
    });
}

fn chart(ui: &Ui, id: &str, title: String, height: f32, overlay: &Overlay) -> Chart {
    let mut chart = Chart::new(id, title, vec2(ui.available_width(), height));
    chart.x = range_of(overlay.time_s.iter().copied()).map_or([0.0, 1.0], with_room);
    chart
}

fn residual(name: &str, colour: egui::Color32, parts: Vec<Vec<[f64; 2]>>) -> Curve {
    Curve { name: name.into(), colour, parts, style: Style::Solid }
}

/// A signal in parts without missing values, in a unit with so many per SI unit.
fn parts(overlay: &Overlay, values: &[Option<f64>], per_si: f64) -> Vec<Vec<[f64; 2]>> {
    let points = overlay.time_s.iter().zip(values).map(|(t, value)| [*t, per_si * value.unwrap_or(f64::NAN)]);
    thinned(&points.collect::<Vec<_>>(), usize::MAX / 4)
}

fn fit(chart: &mut Chart) {
    chart.curves.retain(|curve| !curve.parts.is_empty());
    let values = chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
    chart.y = chart.fitted(range_of(values));
}
