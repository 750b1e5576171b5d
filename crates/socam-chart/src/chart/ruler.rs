//! The horizontal axis of a stack of charts that is longer than the window: it stays in sight below them while they are scrolled.

use egui::{Align2, Rangef, Rect, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};
use egui_plot::GridInput;

use super::axes::step_of_numbers;
use super::grid::{LINES_APART, lines, numbers_apart, text};
use super::{Scale, X_AXIS};

/// Draws the axis below each of the `columns`, the horizontal extents of the frames of charts, with numbers and label.
pub fn ruler(ui: &mut Ui, columns: &[Rangef], range: [f64; 2], scale: Scale, label: &str) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), X_AXIS), Sense::hover());
    let name = format!("Axis {label}");
    response.widget_info(move || WidgetInfo::labeled(Role::Label, true, &name));
    for column in distinct(columns) {
        let frame = Rect::from_x_y_ranges(column, rect.y_range());
        for (share, text) in numbers(range, scale, column.span()) {
            let at = pos2(column.min + share as f32 * column.span(), frame.top() + 2.0);
            let font = TextStyle::Body.resolve(ui.style());
            ui.painter().text(at, Align2::CENTER_TOP, text, font, ui.visuals().text_color());
        }
        let font = egui::FontId::proportional(12.0);
        let at = pos2(frame.center().x, frame.bottom());
        ui.painter().text(at, Align2::CENTER_BOTTOM, label, font, ui.visuals().text_color());
    }
}

/// Columns without those that are the same to a point.
fn distinct(columns: &[Rangef]) -> Vec<Rangef> {
    let mut found: Vec<Rangef> = Vec::new();
    for column in columns {
        let is_known =
            found.iter().any(|own| (own.min - column.min).abs() < 1.0 && (own.max - column.max).abs() < 1.0);
        if !is_known {
            found.push(*column);
        }
    }
    found
}

/// Numbers of an axis of so many points, with their shares of it; none where they would stand beyond its ends.
fn numbers(range: [f64; 2], scale: Scale, points: f32) -> Vec<(f64, String)> {
    let is_log = scale == Scale::Log;
    let [low, high] = if is_log { range.map(f64::log10) } else { range };
    let apart = numbers_apart(scale);
    let is_drawn = points > apart && high > low && low.is_finite() && high.is_finite();
    if !is_drawn {
        return Vec::new();
    }
    let per_point = (high - low) / f64::from(points);
    let input = GridInput { bounds: (low, high), base_step_size: per_point * f64::from(LINES_APART) };
    let least = per_point * f64::from(apart - 0.1);
    let step = step_of_numbers([low, high], points, [LINES_APART, apart]);
    lines(input, scale, apart)
        .into_iter()
        .filter(|mark| {
            (low..=high - 14.0 * per_point).contains(&mark.value) && (is_log || mark.step_size > least)
        })
        .map(|mark| ((mark.value - low) / (high - low), text(scale, mark, step)))
        .filter(|(_, text)| !text.is_empty())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_has_the_numbers_of_its_range() {
        let texts = |range, scale, points| {
            numbers(range, scale, points).into_iter().map(|(_, text)| text).collect::<Vec<_>>()
        };
        assert_eq!(
            texts([0.0, 10.0], Scale::Linear, 600.0),
            ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"]
        );
        assert_eq!(texts([0.5, 500.0], Scale::Log, 300.0), ["1", "10", "100"]);
        assert!(texts([0.0, 0.0], Scale::Linear, 600.0).is_empty());
        let [(share, _), ..] = &numbers([-1.0, 3.0], Scale::Linear, 600.0)[..] else { panic!() };
        assert!((0.0..0.1).contains(share));
    }
}
