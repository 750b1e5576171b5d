//! The mouse wheel above a chart.

use egui::{Rect, Ui};

const ZOOM_PER_POINT: f32 = 0.0035;

/// The horizontal range after a turn of the wheel: zoomed about the pointer, or moved sideways.
pub(super) fn after_wheel(
    ui: &Ui,
    frame: Rect,
    range: std::ops::RangeInclusive<f64>,
    pointer: Option<f64>,
) -> [f64; 2] {
    let bounds = [*range.start(), *range.end()];
    let (delta, modifiers) = ui.input(|input| (input.smooth_scroll_delta(), input.modifiers));
    let Some(centre) = pointer.filter(|_| delta != egui::Vec2::ZERO) else { return bounds };
    if modifiers.shift || delta.x.abs() > delta.y.abs() {
        let moved = f64::from(delta.x + delta.y) * (bounds[1] - bounds[0]) / f64::from(frame.width());
        bounds.map(|bound| bound - moved)
    } else {
        let factor = f64::from((-delta.y * ZOOM_PER_POINT).exp());
        bounds.map(|bound| centre + (bound - centre) * factor)
    }
}
