//! The model's poles on the plane, and as a table.

use egui::{Grid, RichText, ScrollArea, Ui, vec2};
use socam_model::Model;

use crate::draw::chart::{Chart, Curve, Flag, Seen, Style, range_of, with_room};
use crate::parameters::{heads, number};
use crate::theme;

pub(super) fn ui(ui: &mut Ui, model: &Model, seen: &mut Vec<Seen>) {
    let Ok(equations) = model.equations(&model.values()) else {
        ui.label(RichText::new("this model has no linear part to show").color(theme::alarm(ui)));
        return;
    };
    let modes = equations.modes();
    ui.label(
        RichText::new(format!("{} at its file's values; force laws are left out", model.name))
            .color(theme::weak(ui)),
    );
    egui::Panel::right("modes").exact_size(400.0).show(ui, |ui| {
        ScrollArea::both().show(ui, |ui| {
            Grid::new("modes").striped(true).spacing([18.0, 4.0]).show(ui, |ui| {
                heads(ui, &["pole, 1/s", "frequency, Hz", "damping ratio"]);
                for mode in &modes {
                    let pole = mode.pole;
                    let text = if pole.im == 0.0 {
                        number(pole.re)
                    } else {
                        format!("{} +- {} i", number(pole.re), number(pole.im.abs()))
                    };
                    ui.label(RichText::new(text).monospace());
                    ui.label(RichText::new(number(mode.natural_frequency_hz)).monospace());
                    ui.label(RichText::new(number(mode.damping_ratio)).monospace());
                    ui.end_row();
                }
            });
        });
    });
    let points: Vec<[f64; 2]> = equations.poles().iter().map(|pole| [pole.re, pole.im]).collect();
    let mut chart = Chart::new(
        "poles",
        "poles: imaginary part, rad/s",
        vec2(ui.available_width(), ui.available_height()),
    );
    chart.x_label = "real part, 1/s".into();
    // A pole that is far faster than everything that swings would press all others together.
    let swings =
        points.iter().filter(|point| point[1] != 0.0).map(|[re, im]| re.hypot(*im)).fold(0.0, f64::max);
    let near = |point: &&[f64; 2]| swings == 0.0 || point[0] > -2.0 * swings;
    let left = points.iter().filter(|point| !near(point)).count();
    if left > 0 {
        chart.title.push_str(&format!("; {left} further at the left, see the table"));
    }
    let reals = points.iter().filter(near).map(|point| point[0]).chain([0.0]);
    chart.x = range_of(reals).map_or([-1.0, 1.0], with_room);
    chart.y = chart.fitted(range_of(points.iter().map(|point| point[1]).chain([0.0])));
    chart.flags = vec![Flag { x: 0.0, text: "limit of stability".into(), colour: theme::weak(ui) }];
    chart.when_empty = "the model has no states";
    chart.curves = vec![Curve {
        name: "poles".into(),
        colour: theme::line(ui, 0),
        parts: vec![points],
        style: Style::Markers,
    }];
    chart.show(ui, seen);
}
