//! The values at the pointer: a cross, a dot on each curve, and a readout that stays inside of the chart and off the pointer.

use egui::{Color32, Context, FontId, Galley, Painter, Pos2, Rect, Stroke, Ui, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform};
use std::sync::Arc;

use super::{Backdrop, Chart, Curve, Scale, Shown, clock};
use crate::theme;

/// Distance of the readout from the pointer, points.
const APART: f32 = 14.0;
/// Room inside of the readout, points.
const ROOM: f32 = 5.0;
/// Distance from the end of a line up to which its last point is read, points.
const NEAR: f64 = 6.0;
/// Letters of a curve's name.
const LETTERS: usize = 28;

/// The position that all charts of a stack read: where the pointer was in one of them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Linked {
    at: Option<f64>,
    next: Option<f64>,
}

impl Linked {
    /// For [`Chart::hover`].
    #[must_use]
    pub fn at(&self) -> Option<f64> {
        self.at
    }

    /// Takes the position from a chart of the stack.
    pub fn take(&mut self, shown: &Shown) {
        self.next = self.next.or(shown.pointer_x);
    }

    /// Ends the stack of charts: if the position has changed, the charts are drawn again.
    pub fn end(&mut self, ctx: &Context) {
        let next = self.next.take();
        if next != self.at {
            self.at = next;
            ctx.request_repaint();
        }
    }
}

/// Value of one curve at a position.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Reading {
    /// A sample.
    At([f64; 2]),
    /// Position, least and greatest value of many samples.
    Between(f64, [f64; 2]),
    Nothing,
}

/// A line of the readout.
struct Line {
    colour: Option<Color32>,
    text: String,
}

/// Draws the cross and the readout, if there is a position to read.
pub(super) fn show(
    ui: &Ui,
    painter: &Painter,
    transform: &PlotTransform,
    chart: &Chart,
    pointer: Option<Pos2>,
) {
    let [log_x, log_y] = chart.is_log();
    let scaled = |value: f64, log: bool| if log { value.log10() } else { value };
    let own = pointer.map(|at| transform.value_from_position(at).x);
    let own = own.map(|x| if log_x { 10_f64.powf(x) } else { x });
    let Some(x) = chart.hover.or(own) else { return };
    let frame = *transform.frame();
    let across = transform.position_from_point_x(scaled(x, log_x));
    if chart.is_empty() || !frame.x_range().contains(across) || ui.input(|input| input.pointer.any_down()) {
        return;
    }
    let thin = Stroke::new(1.0, theme::weak(ui).gamma_multiply(0.7));
    painter.vline(across, frame.y_range(), thin);
    if let Some(at) = pointer {
        painter.hline(frame.x_range(), at.y, thin);
    }
    let per_point = (chart.x[1] - chart.x[0]).abs() / f64::from(frame.width().max(1.0));
    let mut lines = vec![Line { colour: None, text: position_text(x, chart, log_x, per_point) }];
    for (number, curve) in chart.curves.iter().enumerate() {
        let reading = match chart.readings.get(number) {
            Some(sample) => sample.map_or(Reading::Nothing, Reading::At),
            None => nearest(curve, x, NEAR * per_point),
        };
        if let Reading::At([x, y]) = reading {
            let point = PlotPoint::new(scaled(x, log_x), scaled(chart.on_left(number, y), log_y));
            let at = transform.position_from_point(&point);
            painter.circle(at, 3.5, curve.colour, Stroke::new(1.5, ui.visuals().extreme_bg_color));
        }
        lines.push(Line { colour: Some(curve.colour), text: text(reading, (number, curve), chart) });
    }
    lines.extend(pointer.and_then(|at| of_field(chart, transform, at)));
    readout(ui, painter, frame, (&lines, pointer), across);
}

/// The value of a field at the pointer.
fn of_field(chart: &Chart, transform: &PlotTransform, at: Pos2) -> Option<Line> {
    let point = transform.value_from_position(at);
    let y = format!("{} {}", value_text(point.y), unit(&chart.title));
    let text = match &chart.backdrop {
        Some(Backdrop::Heat(heat)) => match heat.cells().at(point.x, point.y) {
            Some(value) => format!("{y}: {} {}", value_text(value), unit(&heat.colours().label)),
            None => format!("{y}: no value"),
        },
        Some(Backdrop::Cloud(_)) => y,
        None => return None,
    };
    Some(Line { colour: None, text })
}

/// The drawn points of a curve that are nearest to a position; nothing farther than `near` from its ends.
fn nearest(curve: &Curve, x: f64, near: f64) -> Reading {
    let holds = |part: &&Vec<[f64; 2]>| {
        let ends = part.first().zip(part.last());
        let is_near = ends.is_some_and(|(first, last)| first[0] - near <= x && x <= last[0] + near);
        // A line that turns back has several values at one position.
        is_near && part.is_sorted_by(|a, b| a[0] <= b[0])
    };
    let Some(part) = curve.parts.iter().find(holds) else { return Reading::Nothing };
    let after = part.partition_point(|point| point[0] < x);
    let around = [after.checked_sub(1), Some(after)];
    let points = around.into_iter().flatten().filter_map(|index| part.get(index));
    let Some(found) = points.min_by(|a, b| (a[0] - x).abs().total_cmp(&(b[0] - x).abs())) else {
        return Reading::Nothing;
    };
    // Two points at one position are the extremes of many samples.
    let first = part.partition_point(|point| point[0] < found[0]);
    let same = part[first..].iter().take_while(|point| point[0] == found[0]).map(|point| point[1]);
    match super::range_of(same) {
        Some([low, high]) if low < high => Reading::Between(found[0], [low, high]),
        _ => Reading::At(*found),
    }
}

fn position_text(x: f64, chart: &Chart, log: bool, per_point: f64) -> String {
    if let Scale::Clock { at_zero_s } = chart.scales[0] {
        return clock::text(x, at_zero_s, per_point.min(1.0));
    }
    let digits = (-per_point.log10().floor()).clamp(0.0, 12.0) as usize;
    let number = if log { value_text(x) } else { format!("{x:.digits$}") };
    let unit = if chart.x_label.is_empty() { chart.x_unit } else { unit(&chart.x_label) };
    format!("{number} {unit}").trim_end().to_owned()
}

fn text(reading: Reading, (number, curve): (usize, &Curve), chart: &Chart) -> String {
    let label = chart.right.as_ref().filter(|right| number >= right.first).map(|right| &right.label);
    let unit = unit(label.unwrap_or(&chart.title));
    let value = match reading {
        Reading::At([_, y]) => format!("{} {unit}", value_text(y)),
        Reading::Between(_, [low, high]) => format!("{} .. {} {unit}", value_text(low), value_text(high)),
        Reading::Nothing => "no sample".into(),
    };
    // A single curve needs no name: the chart's title says what it is.
    if chart.curves.len() == 1 { value } else { format!("{value}   {}", shortened(&curve.name)) }
}

/// A long name without its middle: its beginning names the channel, its end tells recordings apart.
fn shortened(name: &str) -> String {
    let letters = name.chars().count();
    if letters <= LETTERS {
        return name.to_owned();
    }
    let begin = (LETTERS - 3) / 2;
    let end = name.chars().skip(letters - (LETTERS - 3 - begin));
    name.chars().take(begin).chain("...".chars()).chain(end).collect()
}

/// The unit of a title or label: what stands behind its last comma.
pub(crate) fn unit(label: &str) -> &str {
    label.rsplit_once(", ").map_or("", |(_, unit)| unit)
}

/// Five digits.
pub(crate) fn value_text(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-4..1e6).contains(&value.abs()) {
        return format!("{value:.4e}");
    }
    let digits = (4.0 - value.abs().log10().floor()).clamp(0.0, 8.0) as usize;
    format!("{value:.digits$}")
}

fn readout(ui: &Ui, painter: &Painter, frame: Rect, (lines, pointer): (&[Line], Option<Pos2>), across: f32) {
    let font = FontId::monospace(11.0);
    let lay = |text: &str| painter.layout_no_wrap(text.to_owned(), font.clone(), ui.visuals().text_color());
    let mut galleys: Vec<(Option<Color32>, Arc<Galley>)> =
        lines.iter().map(|line| (line.colour, lay(&line.text))).collect();
    let height = galleys.first().map_or(0.0, |(_, galley)| galley.size().y);
    let fit = (((frame.height() - 2.0 * ROOM - 2.0) / height.max(1.0)) as usize).max(1);
    if galleys.len() > fit {
        let more = galleys.len() - (fit - 1).max(1);
        galleys.truncate((fit - 1).max(1));
        if fit > 1 {
            galleys.push((None, lay(&format!("and {more} more"))));
        }
    }
    let width = galleys.iter().map(|(_, galley)| galley.size().x).fold(0.0, f32::max);
    let size = vec2(width + 12.0, height * galleys.len() as f32) + 2.0 * vec2(ROOM, ROOM);
    let rect = place(frame, size, pointer.unwrap_or(pos2(across, frame.center().y - 0.5 * size.y - APART)));
    let ground = ui.visuals().window_fill.gamma_multiply(0.94);
    painter.rect(rect, 3.0, ground, ui.visuals().window_stroke, egui::StrokeKind::Inside);
    for (row, (colour, galley)) in galleys.into_iter().enumerate() {
        let corner = rect.min + vec2(ROOM, ROOM + row as f32 * height);
        if let Some(colour) = colour {
            let square = Rect::from_center_size(corner + vec2(4.0, 0.5 * height), vec2(7.0, 7.0));
            painter.rect_filled(square, 1.5, colour);
        }
        painter.galley(corner + vec2(12.0, 0.0), galley, ui.visuals().text_color());
    }
}

/// The place of a readout: beside the pointer, inside of the frame, and not over the pointer where there is room for that.
fn place(frame: Rect, size: egui::Vec2, pointer: Pos2) -> Rect {
    let right = pointer.x + APART;
    let left = pointer.x - APART - size.x;
    let x = if right + size.x <= frame.right()
        || left < frame.left() && right - frame.left() < frame.right() - left
    {
        right
    } else {
        left
    };
    let below = pointer.y + APART;
    let y = if below + size.y <= frame.bottom() { below } else { pointer.y - APART - size.y };
    let most = frame.max - size;
    let corner = pos2(x.min(most.x).max(frame.left()), y.min(most.y).max(frame.top()));
    Rect::from_min_size(corner, size)
}

#[cfg(test)]
mod tests;
