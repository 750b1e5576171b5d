//! One chart: curves, bands, shaded ranges and flags on a pair of axes.

mod axes;
mod empty;
mod marks;
mod wheel;

use egui::{Align2, Color32, FontId, Rect, Response, Role, Sense, Ui, Vec2b, WidgetInfo};
use egui_plot::{AxisHints, GridInput, GridMark, Plot, PlotResponse, uniform_grid_spacer};

pub use super::curve::{Curve, Flag, Scale};
pub use super::style::{MarkerShape, Style};
use crate::theme;
use axes::{at_an_end, decade, decades, moved, number, padded, scaled, small, steps, unscaled};
pub use axes::{range_of, with_room};
pub use empty::empty_state;
use wheel::after_wheel;

/// One chart.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Identity, unique among all charts.
    pub id: egui::Id,
    /// Title at the top left: quantity and unit.
    pub title: String,
    /// Quantity and unit of the horizontal axis; if empty, its numbers are not shown.
    pub x_label: String,
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
    /// Shaded ranges of the horizontal axis, such as gaps.
    pub shaded: Vec<([f64; 2], Color32)>,
    /// Bands between two lines: low and high at each x.
    pub bands: Vec<(Vec<[f64; 3]>, Color32)>,
    /// Vertical lines with a text.
    pub flags: Vec<Flag>,
    /// Whether the texts of the flags are drawn, not only their lines.
    pub flag_words: bool,
    /// Text that is shown if there is nothing to draw.
    pub when_empty: &'static str,
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
}

/// Contents of a drawn chart, for exports.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The chart's title.
    pub title: String,
    /// Its horizontal axis.
    pub x_label: String,
    /// Its lines.
    pub curves: Vec<Curve>,
}

/// Width of the numbers beside the vertical axis, points: the same for all charts, so that stacked ones align.
const AXIS_WIDTH: f32 = 58.0;
/// Least distance between lines of the grid, points.
const LINES_APART: f32 = 14.0;
/// Height from which on numbers beside the vertical axis stand farther apart, points.
const TALL: f32 = 260.0;
/// Distance between markers on a marked line, points.
const MARKERS_APART: f64 = 160.0;
/// Height of the horizontal axis with its numbers and label, points.
pub const X_AXIS: f32 = 34.0;
/// Height of the title, points.
const TITLE_STRIP: f32 = 20.0;

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
            size,
            x: [0.0, 1.0],
            y: [0.0, 1.0],
            scales: [Scale::Linear; 2],
            curves: Vec::new(),
            shaded: Vec::new(),
            bands: Vec::new(),
            flags: Vec::new(),
            flag_words: true,
            when_empty: "nothing to draw here",
        }
    }

    /// Range of the vertical axis for values of this range, with margins and room for the title. `x_label` must be set before.
    #[must_use]
    pub fn fitted(&self, range: Option<[f64; 2]>) -> [f64; 2] {
        let Some(range) = range else { return [0.0, 1.0] };
        let log = self.scales[1] == Scale::Log;
        let [low, high] = with_room(scaled(range, log));
        let axis = if self.x_label.is_empty() { 0.0 } else { X_AXIS };
        let strip = f64::from(TITLE_STRIP / (self.size.y - axis - TITLE_STRIP).max(TITLE_STRIP));
        unscaled([low, high + strip * (high - low)], log)
    }

    /// Draws the chart and adds its contents to `seen`.
    pub fn show(self, ui: &mut Ui, seen: &mut Vec<Seen>) -> Shown {
        let [log_x, log_y] = self.scales.map(|scale| scale == Scale::Log);
        let (x, y) = (padded(scaled(self.x, log_x)), padded(scaled(self.y, log_y)));
        let answer = self.plot(ui, x, y);
        let transform = answer.transform;
        let frame = *transform.frame();
        let painter = ui.painter_at(frame.intersect(ui.clip_rect()));
        let at = |value: f64| transform.position_from_point_x(if log_x { value.log10() } else { value });
        for ([from, to], colour) in &self.shaded {
            let rect = Rect::from_x_y_ranges(at(*from)..=at(*to).max(at(*from) + 1.0), frame.y_range());
            painter.rect_filled(rect, 0.0, *colour);
        }
        for (band, colour) in &self.bands {
            marks::band(&painter, &transform, [log_x, log_y], band, *colour);
        }
        marks::flags(ui, &painter, frame, (&self.flags, self.flag_words), at);
        marks::title(ui, &painter, frame, &self.title);
        if self.curves.iter().all(|curve| curve.parts.iter().all(Vec::is_empty)) {
            let font = FontId::proportional(12.5);
            painter.text(frame.center(), Align2::CENTER_CENTER, self.when_empty, font, theme::weak(ui));
        }
        let title = self.title.clone();
        answer.response.widget_info(|| WidgetInfo::labeled(Role::Figure, true, format!("Chart {title}")));
        let pointer = answer.response.hover_pos().filter(|pos| frame.contains(*pos));
        let pointer_at = pointer.map(|pos| transform.value_from_position(pos).x);
        let x_now = after_wheel(ui, frame, transform.bounds().range_x(), pointer_at);
        let y_now = transform.bounds().range_y();
        let y_now = [*y_now.start(), *y_now.end()];
        let beside = |flag: &&Flag| pointer.is_some_and(|pos| (at(flag.x) - pos.x).abs() < 4.0);
        let told: Vec<&str> = self.flags.iter().filter(beside).map(|flag| flag.text.as_str()).collect();
        let response = if told.is_empty() {
            answer.response
        } else {
            answer.response.on_hover_text_at_pointer(told.join("\n"))
        };
        seen.push(Seen { title: self.title, x_label: self.x_label, curves: self.curves });
        Shown {
            response,
            x_moved: moved(x, x_now),
            y_moved: moved(y, y_now),
            x: unscaled(x_now, log_x),
            y: unscaled(y_now, log_y),
            pointer_x: pointer_at.map(|x| if log_x { 10_f64.powf(x) } else { x }),
            frame,
        }
    }

    /// Axes, grid and lines.
    fn plot(&self, ui: &mut Ui, x: [f64; 2], y: [f64; 2]) -> PlotResponse<()> {
        let scales = self.scales.map(|scale| scale == Scale::Log);
        let apart = self.numbers_apart();
        let [x_axis, y_axis] = self.axes(scales, apart);
        let spacer = |side: usize| {
            let numbers = apart[side] / LINES_APART;
            let even = uniform_grid_spacer(move |input| steps(input, numbers));
            let by_decades = Box::new(move |input: GridInput| decades(&input, numbers));
            if scales[side] { by_decades } else { even }
        };
        let plot = Plot::new(self.id)
            .x_grid_spacer(spacer(0))
            .y_grid_spacer(spacer(1))
            .width(self.size.x)
            .height(self.size.y)
            .show_axes(Vec2b::new(!self.x_label.is_empty(), true))
            .custom_x_axes(vec![x_axis])
            .custom_y_axes(vec![y_axis])
            .show_x(false)
            .show_y(false)
            .label_formatter(|_| None)
            .allow_scroll(false)
            .allow_double_click_reset(false)
            .allow_drag(Vec2b::new(true, false))
            .allow_zoom(Vec2b::new(true, false))
            .grid_spacing(egui::Rangef::new(LINES_APART, 160.0))
            .grid_color(theme::grid(ui))
            .grid_fade(0.6)
            .sense(Sense::click_and_drag());
        let per_point = (x[1] - x[0]) / f64::from(self.size.x.max(1.0));
        plot.show(ui, |plot| {
            plot.set_plot_bounds_x(x[0]..=x[1]);
            plot.set_plot_bounds_y(y[0]..=y[1]);
            for (number, curve) in self.curves.iter().enumerate() {
                for part in &curve.parts {
                    marks::draw(plot, curve, part, scales);
                }
                if let Style::Marked(shape) = curve.style {
                    let every = MARKERS_APART * per_point;
                    let first = x[0] + every * (0.2 + 0.13 * number as f64).fract();
                    plot.points(marks::markers(curve, shape, [first, every], scales));
                }
            }
        })
    }

    /// Least distances between the numbers of the two axes, points.
    fn numbers_apart(&self) -> [f32; 2] {
        [56.0, if self.size.y < TALL { 17.5 } else { 32.0 }]
    }

    /// The horizontal and the vertical axis with their numbers.
    fn axes(&self, scales: [bool; 2], apart: [f32; 2]) -> [AxisHints<'static>; 2] {
        let text = |log: bool, mark: GridMark| if log { decade(mark) } else { number(mark) };
        let spacing = apart.map(|least: f32| egui::Rangef::new(least - 0.1, least));
        // The last number is left out near the right end: it would be cut off, or touch the numbers of the next chart.
        let width = self.size.x - AXIS_WIDTH;
        let below = move |mark: GridMark, range: &_| {
            if at_an_end(mark.value, range, width, [0.0, 14.0]) {
                String::new()
            } else {
                text(scales[0], mark)
            }
        };
        let mut x_axis = AxisHints::new_x().formatter(below).label_spacing(spacing[0]);
        if !self.x_label.is_empty() {
            x_axis = x_axis.label(small(&self.x_label));
        }
        let length = self.size.y - if self.x_label.is_empty() { 0.0 } else { X_AXIS };
        // The lowest and highest numbers are left out near the ends, where those of the other axis or of the next chart are.
        let beside = move |mark: GridMark, range: &_| {
            if at_an_end(mark.value, range, length, [7.0; 2]) { String::new() } else { text(scales[1], mark) }
        };
        let y_axis = AxisHints::new_y().formatter(beside).min_thickness(AXIS_WIDTH).label_spacing(spacing[1]);
        [x_axis, y_axis]
    }
}
