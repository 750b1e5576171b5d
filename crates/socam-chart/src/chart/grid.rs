//! The plot of a chart: its axes, its grid, and the layers of its contents.

use std::ops::RangeInclusive;

use egui::{Sense, Shape, Ui, Vec2b};
use egui_plot::{AxisHints, GridInput, GridMark, Plot, PlotResponse, PlotTransform};

use super::axes::{
    at_an_end, decade, decades, even, number, shared_width, small, step_of_numbers, width_of_numbers,
};
use super::layer::Layer;
use super::{Backdrop, Chart, DIMMED, Scale, Style, X_AXIS, clock, marks};
use crate::colours::{self, Colours};
use crate::theme;

/// Least distance between lines of the grid, points.
pub(super) const LINES_APART: f32 = 14.0;
/// Height above which the numbers of the vertical axis are farther apart, points.
const TALL: f32 = 260.0;
/// Distance between markers on a marked line, points.
const MARKERS_APART: f64 = 160.0;

impl Backdrop {
    pub(super) fn colours(&self) -> &Colours {
        match self {
            Self::Cloud(cloud) => &cloud.colours,
            Self::Heat(heat) => heat.colours(),
        }
    }

    fn shapes(&self, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        match self {
            Self::Cloud(cloud) => cloud.shapes(transform, shapes),
            Self::Heat(heat) => heat.shapes(transform, shapes),
        }
    }
}

impl Chart {
    /// Axes, grid and lines.
    pub(super) fn plot(&self, ui: &mut Ui, x: [f64; 2], y: [f64; 2]) -> PlotResponse<()> {
        let (scales, logs) = (self.scales, self.is_log());
        let apart = self.numbers_apart();
        let stack = self.stack.unwrap_or_else(|| ui.scope_id());
        let axis_width = shared_width(ui, stack, self.width_of_numbers(ui, y));
        let has_room = self.backdrop.is_some() || self.right.is_some() || self.leaves_room;
        let width = self.size.x - if has_room { colours::ROOM } else { 0.0 };
        let [x_axis, y_axis] = self.axes([width, axis_width]);
        let spacer = |side: usize| move |input: GridInput| lines(input, scales[side], apart[side]);
        let plot = Plot::new(self.id)
            .x_grid_spacer(spacer(0))
            .y_grid_spacer(spacer(1))
            .width(width)
            .height(self.size.y)
            .show_axes(Vec2b::new(!self.x_label.is_empty(), true))
            .custom_x_axes(vec![x_axis])
            .custom_y_axes(vec![y_axis])
            .show_x(false)
            .show_y(false)
            .label_formatter(|_| None)
            .allow_scroll(false)
            .allow_boxed_zoom(false)
            .allow_double_click_reset(false)
            .allow_drag(Vec2b::new(true, false))
            .allow_zoom(Vec2b::new(true, false))
            .grid_spacing(egui::Rangef::new(LINES_APART, 160.0))
            .grid_color(theme::grid(ui))
            .grid_fade(0.6)
            .sense(Sense::click_and_drag());
        plot.show(ui, |plot| {
            plot.set_plot_bounds_x(x[0]..=x[1]);
            plot.set_plot_bounds_y(y[0]..=y[1]);
            plot.add(Layer::new(|_, transform, shapes| {
                self.backdrop.iter().for_each(|backdrop| backdrop.shapes(transform, shapes));
                marks::shaded(transform, logs[0], &self.shaded, shapes);
                self.bands.iter().for_each(|band| marks::band(transform, logs, band, shapes));
            }));
            self.contents(plot, x);
        })
    }

    /// Lines with their markers, the highlighted one on top.
    fn contents<'a>(&'a self, plot: &mut egui_plot::PlotUi<'a>, x: [f64; 2]) {
        let scales = self.is_log();
        let per_point = (x[1] - x[0]) / f64::from(self.size.x.max(1.0));
        let mut order: Vec<usize> = (0..self.curves.len()).collect();
        order.sort_by_key(|number| self.lit == Some(*number));
        for number in order {
            let curve = self.placed(number);
            let opacity = match self.lit {
                Some(lit) if lit == number => 1.0,
                Some(_) => DIMMED.min(self.opacity),
                None => self.opacity,
            };
            let colour = if opacity < 1.0 { curve.colour.gamma_multiply(opacity) } else { curve.colour };
            let line = curve.clone();
            plot.add(Layer::new(move |ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>| {
                marks::line(ui, transform, scales, (&line, colour), shapes);
            }));
            if let Some(points) = marks::dots(&curve, scales) {
                plot.points(points.color(colour));
            }
            if let Style::Marked(shape) = curve.style {
                let every = MARKERS_APART * per_point;
                let first = x[0] + every * (0.2 + 0.13 * number as f64).fract();
                plot.points(marks::markers(&curve, shape, [first, every], scales).color(colour));
            }
        }
    }

    /// Least distances between the numbers of the two axes, points.
    fn numbers_apart(&self) -> [f32; 2] {
        [numbers_apart(self.scales[0]), if self.size.y < TALL { 17.5 } else { 32.0 }]
    }

    /// Length of the vertical axis, points.
    fn height(&self) -> f32 {
        self.size.y - if self.x_label.is_empty() { 0.0 } else { X_AXIS }
    }

    /// Width of the widest number beside the vertical axis.
    fn width_of_numbers(&self, ui: &Ui, y: [f64; 2]) -> f32 {
        let (scale, apart) = (self.scales[1], self.numbers_apart()[1]);
        let log = self.is_log()[1];
        let per_point = (y[1] - y[0]) / f64::from(self.height().max(1.0));
        let input = GridInput { bounds: (y[0], y[1]), base_step_size: per_point * f64::from(LINES_APART) };
        let inside = |mark: &GridMark| (y[0]..=y[1]).contains(&mark.value);
        let wide = |mark: &GridMark| mark.step_size / per_point > f64::from(apart) - 0.1;
        let marks = lines(input, scale, apart).into_iter().filter(|mark| inside(mark) && (log || wide(mark)));
        let step = step_of_numbers(y, self.height(), [LINES_APART, apart]);
        width_of_numbers(ui, marks.map(|mark| text(scale, mark, step)))
    }

    /// The horizontal and the vertical axis with their numbers, for a plot of this width with so wide numbers.
    fn axes(&self, [width, axis_width]: [f32; 2]) -> [AxisHints<'static>; 2] {
        let (scales, apart) = (self.scales, self.numbers_apart());
        let spacing = apart.map(|least: f32| egui::Rangef::new(least - 0.1, least - 0.0999));
        // The last number is left out near the right end: it would be cut off, or touch the numbers of the next chart.
        let length = width - axis_width;
        let below = move |mark: GridMark, range: &RangeInclusive<f64>| {
            if at_an_end(mark.value, range, length, [0.0, 14.0]) {
                String::new()
            } else {
                let step = step_of_numbers([*range.start(), *range.end()], length, [LINES_APART, apart[0]]);
                text(scales[0], mark, step)
            }
        };
        let mut x_axis = AxisHints::new_x().formatter(below).label_spacing(spacing[0]);
        if !self.x_label.is_empty() {
            x_axis = x_axis.label(small(&self.x_label));
        }
        let (length, is_empty) = (self.height(), self.is_empty());
        // The lowest and highest numbers are left out near the ends, where those of the other axis or of the next chart are. A chart
        // without values has none: its range would be made up.
        let beside = move |mark: GridMark, range: &RangeInclusive<f64>| {
            if is_empty || at_an_end(mark.value, range, length, [7.0; 2]) {
                String::new()
            } else {
                let step = step_of_numbers([*range.start(), *range.end()], length, [LINES_APART, apart[1]]);
                text(scales[1], mark, step)
            }
        };
        let y_axis = AxisHints::new_y().formatter(beside).min_thickness(axis_width).label_spacing(spacing[1]);
        [x_axis, y_axis]
    }
}

/// Least distance between the numbers of a horizontal axis, points.
pub(super) fn numbers_apart(scale: Scale) -> f32 {
    if matches!(scale, Scale::Clock { .. }) { clock::NUMBERS_APART } else { 56.0 }
}

/// Lines of the grid; those with numbers are `apart` points from each other at least.
pub(super) fn lines(input: GridInput, scale: Scale, apart: f32) -> Vec<GridMark> {
    let numbers = apart / LINES_APART;
    match scale {
        Scale::Log => decades(&input, numbers),
        Scale::Linear => even(input, numbers),
        Scale::Clock { at_zero_s } => clock::lines(&input, at_zero_s, numbers),
    }
}

/// A number beside a line of the grid; on an even axis with the digits of the `step` between its numbers.
pub(super) fn text(scale: Scale, mark: GridMark, step: f64) -> String {
    match scale {
        Scale::Log => decade(mark),
        Scale::Linear => number(GridMark { step_size: mark.step_size.min(step), ..mark }),
        Scale::Clock { at_zero_s } => clock::text(mark.value, at_zero_s, mark.step_size),
    }
}
