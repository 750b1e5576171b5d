//! Values as colours, and the bar that says which.

use egui::{Align2, Color32, FontId, Mesh, Painter, Rect, Shape, Ui, epaint::TextShape, pos2, vec2};
use egui_plot::{GridInput, GridMark};

use super::chart::axes;
use crate::theme;

/// Room right of a chart for the bar, its numbers and its label, points.
pub(super) const ROOM: f32 = 84.0;
const BAR: f32 = 12.0;
/// Steps of the bar.
const STEPS: u32 = 64;

/// Colours for the values of a range; values beyond have the colours of its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Colours {
    /// Values of the first and of the last colour.
    pub range: [f64; 2],
    /// Quantity and unit, separated by a comma.
    pub label: String,
    /// The part of the colour map that is used, 0 to 1: dots in the first colours do not show on a dark ground.
    pub part: [f64; 2],
}

impl Colours {
    /// All colours, for fields.
    #[must_use]
    pub fn of_fields(range: [f64; 2], label: impl Into<String>) -> Self {
        Self { range, label: label.into(), part: [0.0, 1.0] }
    }

    /// Colours that show on the ground of charts, for dots and lines.
    #[must_use]
    pub fn of_dots(ui: &Ui, range: [f64; 2], label: impl Into<String>) -> Self {
        let part = if ui.visuals().dark_mode { [0.22, 1.0] } else { [0.0, 0.86] };
        Self { range, label: label.into(), part }
    }

    /// A value's share of the range, 0 to 1.
    #[must_use]
    pub fn share(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 }
    }

    /// The colour of a value; nothing for a missing one.
    #[must_use]
    pub fn of(&self, value: f64) -> Color32 {
        if value.is_nan() { Color32::TRANSPARENT } else { self.at(self.share(value)) }
    }

    /// The colour at a share of the range.
    #[must_use]
    pub fn at(&self, share: f64) -> Color32 {
        let [red, green, blue] = socam_plot::colour(self.part[0] + share * (self.part[1] - self.part[0]));
        Color32::from_rgb(red, green, blue)
    }

    /// Draws the bar right of a chart's frame.
    pub(super) fn bar(&self, ui: &Ui, painter: &Painter, frame: Rect) {
        let bar = Rect::from_min_size(pos2(frame.right() + 10.0, frame.top()), vec2(BAR, frame.height()));
        let height = |share: f64| bar.bottom() - share as f32 * bar.height();
        let mut mesh = Mesh::default();
        for step in 0..=STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            mesh.colored_vertex(pos2(bar.left(), height(share)), self.at(share));
            mesh.colored_vertex(pos2(bar.right(), height(share)), self.at(share));
            if step < STEPS {
                mesh.add_triangle(2 * step, 2 * step + 1, 2 * step + 2);
                mesh.add_triangle(2 * step + 1, 2 * step + 2, 2 * step + 3);
            }
        }
        painter.add(Shape::mesh(mesh));
        let [low, high] = self.range;
        let mut end = bar.right();
        if high > low {
            let least = 14.0 * (high - low) / f64::from(bar.height().max(1.0));
            let [_, step, _] = axes::steps(GridInput { bounds: (low, high), base_step_size: least }, 2.0);
            let first = (low / step).ceil() as i64;
            for index in first..=(high / step).floor() as i64 {
                let value = index as f64 * step;
                // Numbers at the ends of the bar are not cut off.
                let ends = [bar.top() + 6.0, (bar.bottom() - 6.0).max(bar.top() + 6.0)];
                let at = pos2(bar.right() + 5.0, height(self.share(value)).clamp(ends[0], ends[1]));
                let text = axes::number(GridMark { value, step_size: step });
                let font = FontId::proportional(11.0);
                end = end.max(painter.text(at, Align2::LEFT_CENTER, text, font, theme::weak(ui)).right());
            }
        }
        let colour = ui.visuals().text_color();
        let lay = |text: &str, size: f32| {
            painter.layout_no_wrap(text.to_owned(), FontId::proportional(size), colour)
        };
        let whole = lay(&self.label, 12.0);
        // A label that is longer than the bar is set in smaller letters, then without its quantity: the unit says more.
        let label = if whole.size().x <= bar.height() {
            whole
        } else if 0.75 * whole.size().x <= bar.height() {
            lay(&self.label, 9.0)
        } else {
            lay(crate::chart::hover::unit(&self.label), 9.0)
        };
        let x = (end + 6.0).min(frame.right() + ROOM - label.size().y);
        let at = pos2(x, frame.center().y + 0.5 * label.size().x);
        painter.add(TextShape::new(at, label, colour).with_angle(-std::f32::consts::FRAC_PI_2));
    }
}
