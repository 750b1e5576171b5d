//! One chart: lines over an axis that others may share, with what is special about the axis marked.

use egui::{
    Align2, Color32, FontId, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2b, WidgetInfo, pos2, vec2,
};
use egui_plot::{AxisHints, GridMark, Line, LineStyle, Plot, PlotPoint, PlotPoints, Points};

use crate::theme;

/// A line of a chart.
#[derive(Debug, Clone)]
pub struct Curve {
    /// What it is: in exports and where it is pointed at.
    pub name: String,
    /// Its colour.
    pub colour: Color32,
    /// Parts that are not joined, each of points.
    pub parts: Vec<Vec<[f64; 2]>>,
    /// How it is drawn.
    pub style: Style,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A line.
    Solid,
    /// A dashed line.
    Dashed,
    /// A line with a marker at each point.
    Dotted,
    /// Markers only.
    Markers,
}

/// Something at a place of the horizontal axis.
#[derive(Debug, Clone)]
pub struct Flag {
    /// Where.
    pub x: f64,
    /// In a few words; may be empty.
    pub text: String,
    /// Its colour.
    pub colour: Color32,
}

/// What the scale of an axis is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Even.
    #[default]
    Linear,
    /// By decades: values of curves are turned into their decimal logarithms, those that have none are left out.
    Log,
}

/// One chart.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Its own name among all charts.
    pub id: egui::Id,
    /// What is drawn, with its unit: stands at the top left.
    pub title: String,
    /// What the horizontal axis is, with its unit; empty: its numbers are not shown.
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
    /// Stretches of the horizontal axis that are shaded, such as gaps.
    pub shaded: Vec<([f64; 2], Color32)>,
    /// Bands between two lines: low and high at each x.
    pub bands: Vec<(Vec<[f64; 3]>, Color32)>,
    /// Vertical lines with a word.
    pub flags: Vec<Flag>,
    /// Whether the words of the flags are drawn, not only their lines.
    pub flag_words: bool,
    /// What it says where it holds nothing to draw.
    pub when_empty: &'static str,
}

/// What became of a chart.
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
    /// Where the pointer is, on the horizontal axis.
    pub pointer_x: Option<f64>,
    /// Where data are drawn.
    pub frame: Rect,
}

/// What is seen of a chart, for exports.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The chart's title.
    pub title: String,
    /// Its horizontal axis.
    pub x_label: String,
    /// Its lines.
    pub curves: Vec<Curve>,
}

/// Room for the numbers beside the vertical axis: the same for all, so that stacked charts align.
const AXIS_WIDTH: f32 = 58.0;
const ZOOM_PER_POINT: f32 = 0.0035;
/// Height of the title.
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

    /// The vertical axis for values of this range: room at both ends, and above them for the title.
    #[must_use]
    pub fn fitted(&self, range: Option<[f64; 2]>) -> [f64; 2] {
        let Some(range) = range else { return [0.0, 1.0] };
        let log = self.scales[1] == Scale::Log;
        let [low, high] = with_room(scaled(range, log));
        let strip = f64::from(TITLE_STRIP / (self.size.y - TITLE_STRIP).max(TITLE_STRIP));
        unscaled([low, high + strip * (high - low)], log)
    }

    /// Draws it, and adds it to what is seen.
    pub fn show(mut self, ui: &mut Ui, seen: &mut Vec<Seen>) -> Shown {
        let [log_x, log_y] = self.scales.map(|scale| scale == Scale::Log);
        seen.push(Seen {
            title: self.title.clone(),
            x_label: self.x_label.clone(),
            curves: self.curves.clone(),
        });
        let is_empty = self.curves.iter().all(|curve| curve.parts.iter().all(Vec::is_empty));
        let (x, y) = (padded(scaled(self.x, log_x)), padded(scaled(self.y, log_y)));
        let curves = std::mem::take(&mut self.curves);
        let shaded = std::mem::take(&mut self.shaded);
        let bands = std::mem::take(&mut self.bands);
        let axis =
            |log: bool| move |mark: GridMark, _: &_| if log { decade(mark.value) } else { number(mark) };
        let mut x_axis =
            AxisHints::new_x().formatter(axis(log_x)).label_spacing(egui::Rangef::new(44.0, 80.0));
        if !self.x_label.is_empty() {
            x_axis = x_axis.label(small(&self.x_label));
        }
        let plot = Plot::new(self.id)
            .width(self.size.x)
            .height(self.size.y)
            .show_axes(Vec2b::new(!self.x_label.is_empty(), true))
            .custom_x_axes(vec![x_axis])
            .custom_y_axes(vec![
                AxisHints::new_y()
                    .formatter(axis(log_y))
                    .min_thickness(AXIS_WIDTH)
                    .label_spacing(egui::Rangef::new(13.0, 24.0)),
            ])
            .show_x(false)
            .show_y(false)
            .label_formatter(|_| None)
            .allow_scroll(false)
            .allow_double_click_reset(false)
            .allow_drag(Vec2b::new(true, false))
            .allow_zoom(Vec2b::new(true, false))
            .grid_spacing(egui::Rangef::new(14.0, 160.0))
            .grid_color(theme::grid(ui))
            .grid_fade(0.6)
            .sense(Sense::click_and_drag());
        let answer = plot.show(ui, |plot| {
            plot.set_plot_bounds_x(x[0]..=x[1]);
            plot.set_plot_bounds_y(y[0]..=y[1]);
            for curve in &curves {
                for part in &curve.parts {
                    draw(plot, curve, part, [log_x, log_y]);
                }
            }
        });
        let transform = answer.transform;
        let frame = *transform.frame();
        let painter = ui.painter_at(frame.intersect(ui.clip_rect()));
        let at = |value: f64| transform.position_from_point_x(if log_x { value.log10() } else { value });
        for ([from, to], colour) in shaded {
            let rect = Rect::from_x_y_ranges(at(from)..=at(to).max(at(from) + 1.0), frame.y_range());
            painter.rect_filled(rect, 0.0, colour);
        }
        for (band, colour) in bands {
            let point = |x: f64, y: f64| {
                let y = if log_y { y.max(1e-300).log10() } else { y };
                pos2(at(x), transform.position_from_point_y(y))
            };
            for pair in band.windows(2).filter(|pair| pair.iter().flatten().all(|value| value.is_finite())) {
                let [[x0, low0, high0], [x1, low1, high1]] = [pair[0], pair[1]];
                let corners = vec![point(x0, low0), point(x1, low1), point(x1, high1), point(x0, high0)];
                painter.add(Shape::convex_polygon(corners, colour, Stroke::NONE));
            }
        }
        flags(ui, &painter, frame, (&self.flags, self.flag_words), at);
        title(ui, &painter, frame, &self.title);
        if is_empty {
            let font = FontId::proportional(12.5);
            painter.text(frame.center(), Align2::CENTER_CENTER, self.when_empty, font, theme::weak(ui));
        }
        let title = self.title.clone();
        answer.response.widget_info(|| WidgetInfo::labeled(Role::Figure, true, format!("Chart {title}")));
        let mut bounds = [transform.bounds().min()[0], transform.bounds().max()[0]];
        let pointer = answer.response.hover_pos().filter(|pos| frame.contains(*pos));
        let pointer_at = pointer.map(|pos| transform.value_from_position(pos).x);
        let wheel = ui.input(|input| (input.smooth_scroll_delta(), input.modifiers));
        if let (Some(centre), (delta, modifiers)) = (pointer_at, wheel)
            && delta != egui::Vec2::ZERO
        {
            bounds = if modifiers.shift || delta.x.abs() > delta.y.abs() {
                let moved = f64::from(delta.x + delta.y) * (bounds[1] - bounds[0]) / f64::from(frame.width());
                bounds.map(|bound| bound - moved)
            } else {
                let factor = f64::from((-delta.y * ZOOM_PER_POINT).exp());
                bounds.map(|bound| centre + (bound - centre) * factor)
            };
        }
        let y_now = [transform.bounds().min()[1], transform.bounds().max()[1]];
        Shown {
            response: answer.response,
            x_moved: moved(x, bounds),
            y_moved: moved(y, y_now),
            x: unscaled(bounds, log_x),
            y: unscaled(y_now, log_y),
            pointer_x: pointer_at.map(|x| if log_x { 10_f64.powf(x) } else { x }),
            frame,
        }
    }
}

fn draw(plot: &mut egui_plot::PlotUi<'_>, curve: &Curve, part: &[[f64; 2]], [log_x, log_y]: [bool; 2]) {
    let scale = |value: f64, log: bool| if log { value.log10() } else { value };
    let point = |[x, y]: &[f64; 2]| PlotPoint::new(scale(*x, log_x), scale(*y, log_y));
    let points: Vec<PlotPoint> =
        part.iter().map(point).filter(|point| point.x.is_finite() && point.y.is_finite()).collect();
    if matches!(curve.style, Style::Dotted | Style::Markers) || points.len() == 1 {
        let markers = Points::new("", PlotPoints::Owned(points.clone())).color(curve.colour).radius(2.5);
        plot.points(markers.allow_hover(false));
    }
    if curve.style != Style::Markers && points.len() > 1 {
        let line = Line::new("", PlotPoints::Owned(points)).color(curve.colour).width(1.4).allow_hover(false);
        plot.line(if curve.style == Style::Dashed { line.style(LineStyle::dashed_dense()) } else { line });
    }
}

fn title(ui: &Ui, painter: &egui::Painter, frame: Rect, text: &str) {
    let galley =
        painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.5), ui.visuals().text_color());
    let at = frame.left_top() + vec2(7.0, 5.0);
    let ground = ui.visuals().extreme_bg_color.gamma_multiply(0.85);
    painter.rect_filled(Rect::from_min_size(at, galley.size()).expand2(vec2(4.0, 2.0)), 3.0, ground);
    painter.galley(at, galley, ui.visuals().text_color());
}

/// Vertical lines with words: each in the first row from below in which it covers no other.
fn flags(
    ui: &Ui,
    painter: &egui::Painter,
    frame: Rect,
    (flags, words): (&[Flag], bool),
    at: impl Fn(f64) -> f32,
) {
    let mut free: Vec<f32> = Vec::new();
    for flag in flags {
        let x = at(flag.x);
        if !x.is_finite() || !frame.x_range().contains(x) {
            continue;
        }
        painter.vline(x, frame.y_range(), Stroke::new(1.0, flag.colour));
        if flag.text.is_empty() || !words {
            continue;
        }
        let galley = painter.layout_no_wrap(flag.text.clone(), FontId::proportional(10.5), flag.colour);
        let left = (x + 3.0).min(frame.right() - galley.size().x - 2.0).max(frame.left() + 2.0);
        let row = free.iter().position(|free| *free <= left).unwrap_or(free.len());
        let bottom = frame.bottom() - 2.0 - (galley.size().y + 2.0) * row as f32;
        if bottom - galley.size().y < frame.top() + TITLE_STRIP {
            continue;
        }
        let end = left + galley.size().x + 6.0;
        match free.get_mut(row) {
            Some(free) => *free = end,
            None => free.push(end),
        }
        let place = pos2(left, bottom - galley.size().y);
        let ground = ui.visuals().extreme_bg_color.gamma_multiply(0.8);
        painter.rect_filled(Rect::from_min_size(place, galley.size()).expand(1.0), 2.0, ground);
        painter.galley(place, galley, flag.colour);
    }
}

/// A range that can be drawn: finite, and not empty.
fn padded([low, high]: [f64; 2]) -> [f64; 2] {
    if !(low.is_finite() && high.is_finite()) || low > high {
        return [0.0, 1.0];
    }
    let least = 1e-9 * low.abs().max(high.abs()).max(1e-9);
    if high - low > least { [low, high] } else { [low - least.max(0.5), high + least.max(0.5)] }
}

fn scaled(range: [f64; 2], log: bool) -> [f64; 2] {
    if log { range.map(f64::log10) } else { range }
}

fn unscaled(range: [f64; 2], log: bool) -> [f64; 2] {
    if log { range.map(|value| 10_f64.powf(value)) } else { range }
}

fn moved(before: [f64; 2], after: [f64; 2]) -> bool {
    let least = 1e-6 * (before[1] - before[0]).abs();
    (before[0] - after[0]).abs() > least || (before[1] - after[1]).abs() > least
}

fn small(text: &str) -> egui::RichText {
    egui::RichText::new(text).size(12.0)
}

/// A number beside an axis: as many digits as its grid needs.
fn number(mark: GridMark) -> String {
    let step = mark.step_size.abs();
    if mark.value.abs() < 1e-9 * step {
        return "0".into();
    }
    let digits = (-step.log10().floor()).max(0.0);
    if digits > 5.0 || mark.value.abs() >= 1e6 {
        return format!(
            "{:.*e}",
            (mark.value.abs() / step).log10().ceil().clamp(0.0, 6.0) as usize,
            mark.value
        );
    }
    format!("{:.*}", digits as usize, mark.value)
}

/// A number beside a logarithmic axis, whole decades only.
fn decade(log: f64) -> String {
    if (log - log.round()).abs() > 1e-6 {
        return String::new();
    }
    match log.round() as i32 {
        power @ -3..=4 => format!("{}", 10_f64.powi(power)),
        power => format!("1e{power}"),
    }
}

/// A range with room to both sides.
#[must_use]
pub fn with_room([low, high]: [f64; 2]) -> [f64; 2] {
    let room = 0.06 * (high - low);
    if room > 0.0 {
        [low - room, high + room]
    } else {
        [low - 0.5 * low.abs().max(1.0), high + 0.5 * low.abs().max(1.0)]
    }
}

/// The range of all values that are there.
#[must_use]
pub fn range_of(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.fold(None, |range, value| match range {
        None => Some([value; 2]),
        Some([low, high]) => Some([value.min(low), value.max(high)]),
    })
}

/// Where a text stands that says that there is nothing yet, and what to do.
pub fn empty_state(ui: &mut Ui, title: &str, advice: &str) {
    let height = ui.available_height();
    ui.add_space((0.32 * height).max(8.0));
    ui.vertical_centered(|ui| {
        let width = ui.available_width().min(480.0);
        ui.allocate_ui(vec2(width, 0.0), |ui| {
            ui.vertical_centered(|ui| {
                ui.heading(title);
                ui.add_space(4.0);
                ui.label(egui::RichText::new(advice).color(theme::weak(ui)));
            });
        });
    });
}
