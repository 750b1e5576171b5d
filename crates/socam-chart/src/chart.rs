//! One chart: curves, bands, shaded ranges and flags on a pair of axes.

pub(super) mod axes;
mod box_zoom;
mod clock;
mod empty;
mod grid;
pub mod hover;
mod layer;
mod marks;
mod picture;
mod right;
mod ruler;
mod wheel;

use egui::{Align2, Color32, FontId, Rect, Response, Role, Ui, WidgetInfo, vec2};

pub use super::curve::{Curve, Flag, Scale};
pub use super::numbers::range_of;
pub use super::style::{MarkerShape, Style};
use super::{heat::Heat, xy::Cloud};
use crate::theme;
pub use axes::with_room;
use axes::{moved, padded, scaled, unscaled};
pub use empty::empty_state;
pub use picture::take as take_picture;
pub use right::Right;
pub use ruler::ruler;
use wheel::after_wheel;

/// One chart.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Identity, unique among all charts.
    pub id: egui::Id,
    /// Title at the top left: quantity and unit, separated by a comma and a space.
    pub title: String,
    /// Quantity and unit of the horizontal axis; if empty, its numbers are not shown.
    pub x_label: String,
    /// Unit of the horizontal axis where another chart shows its label.
    pub x_unit: &'static str,
    /// Size in points.
    pub size: egui::Vec2,
    /// Range of the horizontal axis.
    pub x: [f64; 2],
    /// Range of the vertical axis.
    pub y: [f64; 2],
    /// Scales of the axes, horizontal and vertical.
    pub scales: [Scale; 2],
    /// Lines.
    pub curves: Vec<Curve>,
    /// The curve that is highlighted: it is drawn on top, the others are dimmed.
    pub lit: Option<usize>,
    /// Opacity of curves, 0 to 1; less than 1 where many lie on each other, see [`opacity`].
    pub opacity: f32,
    /// The stack whose vertical axes are equally wide, so that times stand above each other; without it, all charts of the surrounding
    /// part of the window.
    pub stack: Option<egui::Id>,
    /// Whether room is left for a colour bar, so that this chart has the width of another one that has a bar.
    pub leaves_room: bool,
    /// Cloud of dots or field of colours drawn below the curves, with a colour bar.
    pub backdrop: Option<Backdrop>,
    /// A second vertical axis, of the last curves; both axes are linear.
    pub right: Option<Right>,
    /// Shaded ranges of the horizontal axis, such as gaps.
    pub shaded: Vec<([f64; 2], Color32)>,
    /// Bands between two lines: low and high at each x.
    pub bands: Vec<(Vec<[f64; 3]>, Color32)>,
    /// Vertical lines with a text.
    pub flags: Vec<Flag>,
    /// Whether the texts of the flags are drawn, not only their lines.
    pub flag_words: bool,
    /// Position on the horizontal axis at which values are read, as [`hover::Linked`] gives it to all charts of a stack.
    pub hover: Option<f64>,
    /// The samples of the curves that are nearest to `hover`; empty: the drawn points are read, which may be extremes of many samples.
    pub readings: Vec<Option<[f64; 2]>>,
    /// Text that is shown if there is nothing to draw.
    pub when_empty: &'static str,
}

/// A cloud of dots or a field of colours that is drawn below the curves.
#[derive(Debug, Clone)]
pub enum Backdrop {
    /// Dots with colours, on linear axes.
    Cloud(Cloud),
    /// A field of colours, on linear axes.
    Heat(Heat),
}

/// A chart after it was drawn.
#[derive(Debug)]
pub struct Shown {
    /// For clicks and drags.
    pub response: Response,
    /// The horizontal range after panning and zooming.
    pub x: [f64; 2],
    /// The vertical range after panning and zooming.
    pub y: [f64; 2],
    /// Whether the user changed the horizontal range.
    pub x_moved: bool,
    /// Whether the user changed the vertical range.
    pub y_moved: bool,
    /// Position of the pointer on the horizontal axis.
    pub pointer_x: Option<f64>,
    /// The area of the data.
    pub frame: Rect,
    /// The area of the chart with its axes.
    pub whole: Rect,
}

/// Contents of a drawn chart, for exports.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The chart's title.
    pub title: String,
    /// Label of the horizontal axis.
    pub x_label: String,
    /// Ranges of its axes, horizontal and vertical.
    pub ranges: [[f64; 2]; 2],
    /// Scales of its axes.
    pub scales: [Scale; 2],
    /// Lines of the chart.
    pub curves: Vec<Curve>,
    /// Cloud of dots or field of colours below the lines.
    pub backdrop: Option<Backdrop>,
    /// Shaded ranges of the horizontal axis.
    pub shaded: Vec<([f64; 2], Color32)>,
    /// Bands of the chart.
    pub bands: Vec<(Vec<[f64; 3]>, Color32)>,
    /// Vertical lines of the chart.
    pub flags: Vec<Flag>,
}

/// Height of the horizontal axis with its numbers and label, points.
pub const X_AXIS: f32 = 34.0;
/// Label of an axis of seconds that shows times of day, in exports.
const SECONDS: &str = "time, s";
/// Height of the title, points.
const TITLE_STRIP: f32 = 20.0;
/// Opacity of curves beside a highlighted one.
const DIMMED: f32 = 0.22;

/// Opacity of many curves on each other: where more of them meet, the picture is darker.
#[must_use]
pub fn opacity(curves: usize) -> f32 {
    (6.0 / curves.max(1) as f32).sqrt().clamp(0.2, 1.0)
}

impl Chart {
    /// A chart without lines.
    #[must_use]
    pub fn new(
        id: impl std::hash::Hash + std::fmt::Debug,
        title: impl Into<String>,
        size: egui::Vec2,
    ) -> Self {
        Self {
            id: egui::Id::unique(id),
            title: title.into(),
            x_label: String::new(),
            x_unit: "",
            size,
            x: [0.0, 1.0],
            y: [0.0, 1.0],
            scales: [Scale::Linear; 2],
            curves: Vec::new(),
            lit: None,
            opacity: 1.0,
            stack: None,
            leaves_room: false,
            backdrop: None,
            right: None,
            shaded: Vec::new(),
            bands: Vec::new(),
            flags: Vec::new(),
            flag_words: true,
            hover: None,
            readings: Vec::new(),
            when_empty: "nothing to draw here",
        }
    }

    /// Range of the vertical axis for values of this range, with margins and room for the title. `x_label` must be set before.
    #[must_use]
    pub fn fitted(&self, range: Option<[f64; 2]>) -> [f64; 2] {
        let Some(range) = range else { return [0.0, 1.0] };
        let log = self.is_log()[1];
        let [low, high] = with_room(scaled(range, log));
        let axis = if self.x_label.is_empty() { 0.0 } else { X_AXIS };
        let strip = f64::from(TITLE_STRIP / (self.size.y - axis - TITLE_STRIP).max(TITLE_STRIP));
        unscaled([low, high + strip * (high - low)], log)
    }

    /// Whether the axes are logarithmic.
    fn is_log(&self) -> [bool; 2] {
        self.scales.map(|scale| scale == Scale::Log)
    }

    fn is_empty(&self) -> bool {
        self.backdrop.is_none() && self.curves.iter().all(|curve| curve.parts.iter().all(Vec::is_empty))
    }

    /// Draws the chart and adds its contents to `seen`.
    pub fn show(self, ui: &mut Ui, seen: &mut Vec<Seen>) -> Shown {
        let [log_x, log_y] = self.is_log();
        let (x, y) = (padded(scaled(self.x, log_x)), padded(scaled(self.y, log_y)));
        let corner = ui.cursor().min;
        let answer = self.plot(ui, x, y);
        let transform = answer.transform;
        let frame = *transform.frame();
        let whole = Rect::from_min_size(corner, self.size);
        let painter = ui.painter_at(frame.intersect(ui.clip_rect()));
        let at = |value: f64| transform.position_from_point_x(if log_x { value.log10() } else { value });
        marks::flags(ui, &painter, frame, (&self.flags, self.flag_words), at);
        marks::title(ui, &painter, frame, &self.title);
        if let Some(backdrop) = &self.backdrop {
            backdrop.colours().bar(ui, &ui.painter_at(whole.intersect(ui.clip_rect())), frame);
        }
        if let Some(right) = &self.right {
            right.axis(ui, &ui.painter_at(whole.intersect(ui.clip_rect())), frame);
        }
        if self.is_empty() {
            let font = FontId::proportional(12.5);
            let words = painter.layout_no_wrap(self.when_empty.to_owned(), font, theme::weak(ui));
            let place = Align2::CENTER_CENTER.anchor_size(frame.center(), words.size());
            painter.rect_filled(place.expand2(vec2(4.0, 1.0)), 2.0, ui.visuals().extreme_bg_color);
            painter.galley(place.min, words, theme::weak(ui));
        }
        let title = self.title.clone();
        answer.response.widget_info(|| WidgetInfo::labeled(Role::Figure, true, format!("Chart {title}")));
        let pointer = answer.response.hover_pos().filter(|pos| frame.contains(*pos));
        let pointer_at = pointer.map(|pos| transform.value_from_position(pos).x);
        let mut x_now = after_wheel(ui, frame, transform.bounds().range_x(), pointer_at);
        let y_now = transform.bounds().range_y();
        let mut y_now = [*y_now.start(), *y_now.end()];
        if let Some([across, up]) = box_zoom::after_box(ui, &painter, &answer.response, &transform) {
            (x_now, y_now) = (across.unwrap_or(x_now), up.unwrap_or(y_now));
        }
        // Taken before the values at the pointer are drawn.
        let response = picture::menu(ui, answer.response, whole);
        hover::show(ui, &painter, &transform, &self, pointer);
        let beside = |flag: &&Flag| pointer.is_some_and(|pos| (at(flag.x) - pos.x).abs() < 4.0);
        let told: Vec<&str> = self.flags.iter().filter(beside).map(|flag| flag.text.as_str()).collect();
        let response =
            if told.is_empty() { response } else { response.on_hover_text_at_pointer(told.join("\n")) };
        let ranges = [unscaled(x, log_x), unscaled(y, log_y)];
        seen.extend(self.seen(ranges));
        Shown {
            response,
            x_moved: moved(x, x_now),
            y_moved: moved(y, y_now),
            x: unscaled(x_now, log_x),
            y: unscaled(y_now, log_y),
            pointer_x: pointer_at.map(|x| if log_x { 10_f64.powf(x) } else { x }),
            frame,
            whole,
        }
    }

    /// The contents for exports; those of a second axis are a chart of their own.
    fn seen(mut self, ranges: [[f64; 2]; 2]) -> Vec<Seen> {
        let right = self.right.take().map(|right| {
            let curves = self.curves.split_off(right.first.min(self.curves.len()));
            (Self { title: right.label, curves, backdrop: None, bands: Vec::new(), ..self.clone() }, right.y)
        });
        let seen = |chart: Self, ranges| Seen {
            title: chart.title,
            x_label: if matches!(chart.scales[0], Scale::Clock { .. }) {
                SECONDS.into()
            } else {
                chart.x_label
            },
            ranges,
            scales: chart.scales,
            curves: chart.curves,
            backdrop: chart.backdrop,
            shaded: chart.shaded,
            bands: chart.bands,
            flags: chart.flags,
        };
        let beside = right.map(|(chart, y)| seen(chart, [ranges[0], y]));
        std::iter::once(seen(self, ranges)).chain(beside).collect()
    }
}

#[cfg(test)]
pub(super) mod tests;
