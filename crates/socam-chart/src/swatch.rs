//! The colour of a line, as lists and legends show it.

use egui::{Role, Sense, Stroke, Ui, WidgetInfo, vec2};

use crate::style::MarkerShape;
use crate::theme;

/// A small square of a line's colour, with its marker where it has one.
pub fn swatch(ui: &mut Ui, number: usize, name: &str) {
    let (rect, response) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
    let painter = ui.painter();
    let colour = theme::line(ui, number);
    painter.rect(rect, 2.0, colour, Stroke::NONE, egui::StrokeKind::Inside);
    let ink = ui.visuals().extreme_bg_color;
    let corners = |corners: &[(f32, f32)]| {
        let corners = corners.iter().map(|(x, y)| rect.center() + vec2(*x, *y)).collect();
        painter.add(egui::Shape::convex_polygon(corners, ink, Stroke::NONE));
    };
    match theme::marker(number) {
        None => {}
        Some(MarkerShape::Diamond) => corners(&[(0.0, -4.5), (4.5, 0.0), (0.0, 4.5), (-4.5, 0.0)]),
        Some(MarkerShape::Square) => corners(&[(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)]),
        Some(MarkerShape::Up) => corners(&[(0.0, -4.0), (4.0, 3.0), (-4.0, 3.0)]),
        Some(MarkerShape::Down) => corners(&[(0.0, 4.0), (-4.0, -3.0), (4.0, -3.0)]),
        Some(_) => drop(painter.circle_filled(rect.center(), 3.0, ink)),
    }
    let name = name.to_owned();
    response.widget_info(move || WidgetInfo::labeled(Role::Image, true, format!("colour of {name}")));
}
