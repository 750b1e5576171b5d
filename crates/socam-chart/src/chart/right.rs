//! A second vertical axis at the right of a chart.

use std::borrow::Cow;

use egui::{Align2, FontId, Painter, Rect, Stroke, Ui, epaint::TextShape, pos2};
use egui_plot::{GridInput, GridMark};

use super::{Chart, axes};
use crate::colours::ROOM;
use crate::curve::Curve;
use crate::theme;

/// Length of the marks beside the frame, points.
const MARK: f32 = 5.0;
/// Least distance of numbers, points.
const APART: f64 = 14.0;

/// A second vertical axis at the right.
#[derive(Debug, Clone, PartialEq)]
pub struct Right {
    /// Quantities and unit, separated by a comma and a space.
    pub label: String,
    /// The first of its curves, which are the last ones of the chart.
    pub first: usize,
    /// Its range, from the lower to the upper end of the chart.
    pub y: [f64; 2],
}

impl Right {
    /// The range of this axis when the left one goes from the range `before` to `after`.
    #[must_use]
    pub fn moved(&self, before: [f64; 2], after: [f64; 2]) -> [f64; 2] {
        after.map(|value| placed(value, before, self.y))
    }

    /// Draws marks, numbers and the label right of a chart's frame.
    pub(super) fn axis(&self, ui: &Ui, painter: &Painter, frame: Rect) {
        let [low, high] = self.y;
        if !(high > low && frame.height() > 1.0) {
            return;
        }
        let colour = theme::body(ui);
        painter.vline(frame.right(), frame.y_range(), Stroke::new(1.0, theme::weak(ui)));
        let least = APART * (high - low) / f64::from(frame.height());
        let [_, step, _] = axes::steps(GridInput { bounds: (low, high), base_step_size: least }, 1.25);
        let mut end = frame.right() + MARK;
        for index in (low / step).ceil() as i64..=(high / step).floor() as i64 {
            let value = index as f64 * step;
            let y = frame.bottom() - (placed(value, self.y, [0.0, 1.0]) as f32) * frame.height();
            let from = pos2(frame.right(), y);
            painter.hline(frame.right()..=frame.right() + MARK, y, Stroke::new(1.0, theme::weak(ui)));
            // Numbers at the ends are left out: they would touch those of the chart above or below.
            if (frame.top() + 7.0..=frame.bottom() - 7.0).contains(&y) {
                let text = axes::number(GridMark { value, step_size: step });
                let at = from + egui::vec2(MARK + 3.0, 0.0);
                let number = painter.text(at, Align2::LEFT_CENTER, text, FontId::proportional(11.5), colour);
                end = end.max(number.right());
            }
        }
        let lay = |text: &str, size: f32| {
            painter.layout_no_wrap(text.to_owned(), FontId::proportional(size), colour)
        };
        let whole = lay(&self.label, 12.0);
        // A label that is longer than the axis is set in smaller letters, then without its quantity: the unit says more.
        let label = if whole.size().x <= frame.height() {
            whole
        } else if 0.75 * whole.size().x <= frame.height() {
            lay(&self.label, 9.0)
        } else {
            lay(super::hover::unit(&self.label), 10.0)
        };
        let x = (end + 6.0).min(frame.right() + ROOM - label.size().y - 2.0);
        let at = pos2(x, frame.center().y + 0.5 * label.size().x);
        painter.add(TextShape::new(at, label, colour).with_angle(-std::f32::consts::FRAC_PI_2));
    }
}

/// A value of one range at the same share of another one.
fn placed(value: f64, [low, high]: [f64; 2], [from, to]: [f64; 2]) -> f64 {
    from + (value - low) / (high - low) * (to - from)
}

impl Chart {
    /// The value of the left axis beside which a value of a curve stands.
    pub(super) fn on_left(&self, number: usize, value: f64) -> f64 {
        match &self.right {
            Some(right) if number >= right.first => placed(value, right.y, self.y),
            _ => value,
        }
    }

    /// A curve with values of the left axis.
    pub(super) fn placed(&self, number: usize) -> Cow<'_, Curve> {
        let curve = &self.curves[number];
        if self.right.as_ref().is_none_or(|right| number < right.first) {
            return Cow::Borrowed(curve);
        }
        let mut own = curve.clone();
        own.parts.iter_mut().flatten().for_each(|point| point[1] = self.on_left(number, point[1]));
        Cow::Owned(own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Color32;

    #[test]
    fn a_curve_of_the_right_axis_stands_where_its_axis_says() {
        let curve = |y: f64| Curve {
            name: "c".into(),
            colour: Color32::RED,
            parts: vec![vec![[0.0, y], [1.0, y]]],
            style: crate::style::Style::Solid,
        };
        let mut chart = Chart::new("right", "speed, rad/s", egui::vec2(300.0, 200.0));
        chart.y = [-10.0, 10.0];
        chart.curves = vec![curve(5.0), curve(0.75)];
        chart.right = Some(Right { label: "torque, N m".into(), first: 1, y: [0.0, 1.0] });
        assert_eq!((chart.placed(0).parts[0][0][1], chart.placed(1).parts[0][0][1]), (5.0, 5.0));
        // Zooming the left axis to its upper half zooms the right one, too.
        let right = chart.right.clone().unwrap();
        assert_eq!(right.moved([-10.0, 10.0], [0.0, 10.0]), [0.5, 1.0]);
        // An export has a chart for each axis, with the values as they are.
        let seen = chart.seen([[0.0, 1.0], [-10.0, 10.0]]);
        let of = |number: usize| {
            (seen[number].title.as_str(), seen[number].ranges[1], seen[number].curves[0].parts[0][0][1])
        };
        assert_eq!(
            (seen.len(), of(0), of(1)),
            (2, ("speed, rad/s", [-10.0, 10.0], 5.0), ("torque, N m", [0.0, 1.0], 0.75))
        );
    }
}
