//! Contents of a chart: lines, markers, bands, flags and the title.

use egui::text::{LayoutJob, TextWrapping};
use std::sync::Arc;

use egui::{Color32, FontId, Galley, Painter, Rangef, Rect, Shape, Stroke, Ui, pos2, vec2};
use egui_plot::{MarkerShape, PlotPoint, PlotPoints, PlotTransform, Points};

use super::TITLE_STRIP;
use crate::curve::{Curve, Flag};
use crate::style::Style;
use crate::trace::{self, Pen};

/// Markers on a line, evenly apart on the horizontal axis.
pub(super) fn markers(
    curve: &Curve,
    shape: MarkerShape,
    [first, every]: [f64; 2],
    scales: [bool; 2],
) -> Points<'static> {
    let points = curve.parts.iter().flatten().filter_map(|point| scaled(*point, scales));
    let mut next = first;
    let mut chosen = Vec::new();
    for point in points {
        if point.x >= next {
            next = first + ((point.x - first) / every).floor() * every + every;
            chosen.push(point);
        }
    }
    Points::new("", PlotPoints::Owned(chosen)).radius(4.5).shape(shape).allow_hover(false)
}

/// The markers of a curve that has one at each point, and of parts that are single points.
pub(super) fn dots(curve: &Curve, scales: [bool; 2]) -> Option<Points<'static>> {
    let all = matches!(curve.style, Style::Markers(_) | Style::Dotted);
    let parts = curve.parts.iter().filter(|part| all || part.len() == 1);
    let points: Vec<PlotPoint> = parts.flatten().filter_map(|point| scaled(*point, scales)).collect();
    if points.is_empty() {
        return None;
    }
    let dots = Points::new("", PlotPoints::Owned(points)).allow_hover(false);
    Some(match curve.style {
        Style::Markers(shape) => dots.shape(shape).filled(shape == MarkerShape::Cross).radius(5.0),
        _ => dots.radius(2.5),
    })
}

/// The point on axes of which some are logarithmic; `None` if they cannot show it.
fn scaled([x, y]: [f64; 2], [log_x, log_y]: [bool; 2]) -> Option<PlotPoint> {
    let scale = |value: f64, log: bool| if log { value.log10() } else { value };
    let point = PlotPoint::new(scale(x, log_x), scale(y, log_y));
    (point.x.is_finite() && point.y.is_finite()).then_some(point)
}

/// Draws the lines of a curve.
pub(super) fn line(
    ui: &Ui,
    transform: &PlotTransform,
    scales: [bool; 2],
    (curve, colour): (&Curve, Color32),
    shapes: &mut Vec<Shape>,
) {
    if matches!(curve.style, Style::Markers(_)) {
        return;
    }
    let pen = Pen {
        colour,
        width: trace::width(curve.style),
        is_dashed: curve.style == Style::Dashed,
        pixels_per_point: ui.pixels_per_point(),
    };
    // The computation is in 64 bits, so that far points do not move near ones.
    let (frame, bounds) = (*transform.frame(), *transform.bounds());
    let [[left, bottom], [per_x, per_y]] = [bounds.min(), transform.dpos_dvalue()];
    let place = |point: &[f64; 2]| {
        let point = scaled(*point, scales)?;
        let x = f64::from(frame.left()) + (point.x - left) * per_x;
        Some([x, f64::from(frame.bottom()) + (point.y - bottom) * per_y])
    };
    for part in &curve.parts {
        let points: Vec<[f64; 2]> = part.iter().filter_map(place).collect();
        pen.draw(&points, frame.intersect(ui.clip_rect()), shapes);
    }
}

/// Shades ranges of the horizontal axis.
pub(super) fn shaded(
    transform: &PlotTransform,
    log: bool,
    ranges: &[([f64; 2], Color32)],
    shapes: &mut Vec<Shape>,
) {
    let frame = *transform.frame();
    for (range, colour) in ranges {
        let [from, to] = range.map(|x| transform.position_from_point_x(if log { x.log10() } else { x }));
        let across = from.max(frame.left() - 2.0)..=to.max(from + 1.0).min(frame.right() + 2.0);
        shapes.push(Shape::rect_filled(Rect::from_x_y_ranges(across, frame.y_range()), 0.0, *colour));
    }
}

/// Fills the area between two lines.
pub(super) fn band(
    transform: &PlotTransform,
    [log_x, log_y]: [bool; 2],
    (band, colour): &(Vec<[f64; 3]>, Color32),
    shapes: &mut Vec<Shape>,
) {
    let point = |x: f64, y: f64| {
        let x = if log_x { x.log10() } else { x };
        let y = if log_y { y.max(1e-300).log10() } else { y };
        pos2(transform.position_from_point_x(x), transform.position_from_point_y(y))
    };
    for pair in band.windows(2).filter(|pair| pair.iter().flatten().all(|value| value.is_finite())) {
        let [[x0, low0, high0], [x1, low1, high1]] = [pair[0], pair[1]];
        let corners = vec![point(x0, low0), point(x1, low1), point(x1, high1), point(x0, high0)];
        shapes.push(Shape::convex_polygon(corners, *colour, Stroke::NONE));
    }
}

/// Size of the letters of a title in a narrow chart, points.
const SMALLEST_TITLE: f32 = 9.0;

pub(super) fn title(ui: &Ui, painter: &Painter, frame: Rect, text: &str) {
    let galley =
        |size| painter.layout_no_wrap(text.to_owned(), FontId::proportional(size), ui.visuals().text_color());
    let (size, room) = (12.5, frame.width() - 14.0);
    let whole = galley(size);
    // In a narrow chart the title is set in smaller letters, so that it is not cut off.
    let narrow = whole.size().x > room;
    let galley = if narrow { galley((size * room / whole.size().x).max(SMALLEST_TITLE)) } else { whole };
    let galley = if galley.size().x > room + 1.0 { elided(ui, painter, text, room) } else { galley };
    let at = frame.left_top() + vec2(7.0, 5.0);
    let ground = ui.visuals().extreme_bg_color.gamma_multiply(0.85);
    painter.rect_filled(Rect::from_min_size(at, galley.size()).expand2(vec2(4.0, 2.0)), 3.0, ground);
    painter.galley(at, galley, ui.visuals().text_color());
}

/// A title that is too long even in small letters: its name ends in dots, and its unit, which stands behind the last comma, stays.
fn elided(ui: &Ui, painter: &Painter, text: &str, room: f32) -> Arc<Galley> {
    let cut = |name: &str, room: f32| {
        let font = FontId::proportional(SMALLEST_TITLE);
        let mut job = LayoutJob::simple_singleline(name.to_owned(), font, ui.visuals().text_color());
        job.wrap = TextWrapping::truncate_at_width(room.max(1.0));
        painter.layout_job(job)
    };
    let Some((name, unit)) = text.rsplit_once(", ") else { return cut(text, room) };
    let mut rest = name;
    let with_unit = |rest: &str| {
        let font = FontId::proportional(SMALLEST_TITLE);
        painter.layout_no_wrap(format!("{}..., {unit}", rest.trim_end()), font, ui.visuals().text_color())
    };
    loop {
        let galley = with_unit(rest);
        if galley.size().x <= room {
            return galley;
        }
        match rest.char_indices().next_back() {
            Some((end, _)) if end >= LEAST_NAME => rest = &rest[..end],
            // A chart too narrow for name and unit.
            _ => return cut(text, room),
        }
    }
}

/// Bytes of its name that a title keeps before its unit.
const LEAST_NAME: usize = 4;

/// Greatest number of rows of flag texts, and of letters in each; the full texts are shown at the pointer.
const WORD_ROWS: usize = 2;
/// Length of a short line, points.
const SHORT: f32 = 14.0;
const LETTERS: usize = 52;

/// Draws vertical lines with texts; each text is in the lowest row where it covers no other.
pub(super) fn flags(
    ui: &Ui,
    painter: &Painter,
    frame: Rect,
    (flags, words): (&[Flag], bool),
    at: impl Fn(f64) -> f32,
) {
    let mut free: Vec<f32> = Vec::new();
    let places = flags.iter().map(|flag| (at(flag.x), flag));
    let visible: Vec<_> = places.filter(|(x, _)| x.is_finite() && frame.x_range().contains(*x)).collect();
    // Lines end below texts.
    for (x, flag) in &visible {
        let whole = frame.y_range();
        let part =
            if flag.is_short { Rangef::new((whole.max - SHORT).max(whole.min), whole.max) } else { whole };
        painter.vline(*x, part, Stroke::new(1.0, flag.colour));
    }
    for (x, flag) in visible.into_iter().filter(|(_, flag)| words && !flag.text.is_empty()) {
        let word = shortened(&flag.text);
        let galley = painter.layout_no_wrap(word, FontId::proportional(10.5), flag.colour);
        let left = (x + 3.0).min(frame.right() - galley.size().x - 2.0).max(frame.left() + 2.0);
        let row = free.iter().position(|free| *free <= left).unwrap_or(free.len());
        let bottom = frame.bottom() - 2.0 - (galley.size().y + 2.0) * row as f32;
        if row >= WORD_ROWS || bottom - galley.size().y < frame.top() + TITLE_STRIP {
            continue;
        }
        let end = left + galley.size().x + 6.0;
        match free.get_mut(row) {
            Some(free) => *free = end,
            None => free.push(end),
        }
        let place = pos2(left, bottom - galley.size().y);
        let ground = ui.visuals().extreme_bg_color.gamma_multiply(0.6);
        painter.rect_filled(Rect::from_min_size(place, galley.size()).expand(1.0), 2.0, ground);
        painter.galley(place, galley, flag.colour);
    }
}

fn shortened(text: &str) -> String {
    if text.chars().count() <= LETTERS {
        return text.to_owned();
    }
    text.chars().take(LETTERS - 3).chain("...".chars()).collect()
}
