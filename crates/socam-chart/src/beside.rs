//! Measured signals beside predicted ones: predictions are wide lines below, the measurement is a thin line in the colour of text on top,
//! so that each is seen where they agree.

use egui::{Color32, Pos2, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::curve::Curve;
use crate::style::Style;
use crate::{theme, trace};

/// Colour of measured signals.
#[must_use]
pub fn ink(ui: &Ui) -> Color32 {
    ui.visuals().strong_text_color()
}

/// A measured signal; it is to be the last of its chart's curves.
#[must_use]
pub fn measured(ui: &Ui, parts: Vec<Vec<[f64; 2]>>) -> Curve {
    Curve { name: "measured".into(), colour: ink(ui), parts, style: Style::Thin }
}

/// A prediction below a measured signal.
#[must_use]
pub fn predicted(name: &str, colour: Color32, parts: Vec<Vec<[f64; 2]>>) -> Curve {
    Curve { name: name.into(), colour, parts, style: Style::Broad }
}

/// A prediction below another one.
#[must_use]
pub fn predicted_before(name: &str, colour: Color32, parts: Vec<Vec<[f64; 2]>>) -> Curve {
    Curve { name: name.into(), colour, parts, style: Style::Wide }
}

/// An entry of a legend: the line as it is drawn, and its name.
pub fn legend(ui: &mut Ui, name: &str, colour: Color32, style: Style) {
    let (rect, response) = ui.allocate_exact_size(vec2(22.0, 14.0), Sense::hover());
    let y = rect.center().y;
    let ends: [Pos2; 2] = [pos2(rect.left(), y), pos2(rect.right(), y)];
    let stroke = Stroke::new(trace::width(style), colour);
    if style == Style::Dashed {
        ui.painter().extend(Shape::dashed_line(&ends, stroke, trace::DASH[0], trace::DASH[1]));
    } else {
        ui.painter().line_segment(ends, stroke);
    }
    let said = format!("line of {name}");
    response.widget_info(move || WidgetInfo::labeled(Role::Image, true, &said));
    ui.label(egui::RichText::new(name).small().color(theme::body(ui)));
}
