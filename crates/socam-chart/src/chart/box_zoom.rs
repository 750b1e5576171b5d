//! Zooming to a box that is drawn with the right button.

use egui::{Key, Painter, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, Ui, Vec2};
use egui_plot::PlotTransform;

use crate::theme;

/// A side shorter than this does not zoom its axis, points: a flat box zooms the horizontal axis only.
const SHORTEST: f32 = 6.0;

/// The ranges to zoom to, where an axis is to change: horizontal and vertical.
type Box = [Option<[f64; 2]>; 2];

/// The corners of a box that is being drawn.
#[derive(Clone, Copy)]
struct Drawn([Pos2; 2]);

/// The box, once the button is released, wherever the pointer is then. What lies outside of the chart is cut off; Esc cancels.
pub(super) fn after_box(
    ui: &Ui,
    painter: &Painter,
    response: &Response,
    transform: &PlotTransform,
) -> Option<Box> {
    let id = response.id.with("box");
    let frame = *transform.frame();
    if response.drag_started_by(PointerButton::Secondary)
        && let Some(start) = ui.input(|input| input.pointer.press_origin())
    {
        ui.data_mut(|data| data.insert_temp(id, Drawn([frame.clamp(start); 2])));
    }
    let Drawn([start, last]) = ui.data(|data| data.get_temp::<Drawn>(id))?;
    if ui.input(|input| input.key_pressed(Key::Escape)) {
        ui.data_mut(|data| data.remove::<Drawn>(id));
        return None;
    }
    // If the pointer has left the window, the box ends at the pointer's last known position.
    let end = ui.input(|input| input.pointer.latest_pos()).map_or(last, |at| frame.clamp(at));
    if response.dragged_by(PointerButton::Secondary) {
        ui.data_mut(|data| data.insert_temp(id, Drawn([start, end])));
        let colour = ui.visuals().strong_text_color();
        let inside = theme::weak(ui).gamma_multiply(0.18);
        let part = marked(start, end, frame);
        painter.rect(part, 0.0, inside, Stroke::new(1.0, colour), StrokeKind::Inside);
        return None;
    }
    ui.data_mut(|data| data.remove::<Drawn>(id));
    let size = Vec2::new((end.x - start.x).abs(), (end.y - start.y).abs());
    let values = [start, end].map(|at| transform.value_from_position(at));
    let ordered = |a: f64, b: f64| [a.min(b), a.max(b)];
    let across = (size.x >= SHORTEST).then(|| ordered(values[0].x, values[1].x));
    let up = (size.y >= SHORTEST).then(|| ordered(values[0].y, values[1].y));
    (across.is_some() || up.is_some()).then_some([across, up])
}

/// The part of the chart that a box zooms to: the whole height, or width, along an axis that stays.
fn marked(start: Pos2, end: Pos2, frame: Rect) -> Rect {
    let mut part = Rect::from_two_pos(start, end);
    if part.height() < SHORTEST && part.width() >= SHORTEST {
        (part.min.y, part.max.y) = (frame.top(), frame.bottom());
    } else if part.width() < SHORTEST && part.height() >= SHORTEST {
        (part.min.x, part.max.x) = (frame.left(), frame.right());
    }
    part
}
