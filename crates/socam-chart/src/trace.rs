//! The line of a curve as shapes. No shape leaves the range of the curve's values by more than the width of the line.
//!
//! Stretches with more points than columns of pixels are drawn column by column ([`columns`]), others as paths. `egui_plot` draws
//! the former as `BandShape`s, whose soft edge shoots out of sharp corners by tens of pixels.

mod columns;

use egui::{Color32, Pos2, Rect, Shape, Stroke, pos2};

use crate::style::Style;

/// Width of lines, points. Thinner lines fade between two rows of pixels.
const WIDTH: f32 = 1.7;
/// Length of a dash and of the space after it, points.
pub(super) const DASH: [f32; 2] = [5.0, 3.1];
/// Number of points that are judged together whether they are dense.
const GROUP: usize = 32;
/// Distance beyond the clip rectangle at which lines are cut, points: large coordinates lose digits as 32-bit numbers.
const BEYOND: f64 = 32.0;

/// Width of a line of this style, points.
pub(super) fn width(style: Style) -> f32 {
    match style {
        Style::Wide => 5.0,
        Style::Broad => 3.2,
        Style::Thin => 1.0,
        _ => WIDTH,
    }
}

/// A pen for lines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub(super) colour: Color32,
    /// Points.
    pub(super) width: f32,
    pub(super) is_dashed: bool,
    pub(super) pixels_per_point: f32,
}

impl Pen {
    /// Adds the line through points on the screen, of which only those near `clip` are drawn.
    pub(super) fn draw(self, points: &[[f64; 2]], clip: Rect, shapes: &mut Vec<Shape>) {
        // A chart that is scrolled out of sight.
        if !clip.is_positive() {
            return;
        }
        let is_ordered = points.is_sorted_by(|a, b| a[0] <= b[0]);
        let points = if is_ordered { within(points, clip) } else { points };
        if !is_ordered || self.is_dashed {
            return self.path(points, clip, shapes);
        }
        for (stretch, is_dense) in stretches(points) {
            if is_dense {
                shapes.extend(columns::mesh(stretch, clip, self));
            } else {
                self.path(stretch, clip, shapes);
            }
        }
    }

    fn path(self, points: &[[f64; 2]], clip: Rect, shapes: &mut Vec<Shape>) {
        let stroke = Stroke::new(self.width, self.colour);
        for run in inside(points, clip) {
            if self.is_dashed {
                shapes.extend(Shape::dashed_line(&run, stroke, DASH[0], DASH[1]));
            } else {
                shapes.push(Shape::line(run, stroke));
            }
        }
    }
}

/// The points that a picture of `clip` needs: those inside of its horizontal range and one more at either side.
fn within(points: &[[f64; 2]], clip: Rect) -> &[[f64; 2]] {
    let first = points.partition_point(|[x, _]| *x < f64::from(clip.left()) - 2.0).saturating_sub(1);
    let last = points.partition_point(|[x, _]| *x <= f64::from(clip.right()) + 2.0) + 1;
    &points[first..last.min(points.len()).max(first)]
}

/// Stretches of points, each sharing its end with the next one's start, and whether they have more points than the screen has columns.
fn stretches(points: &[[f64; 2]]) -> Vec<(&[[f64; 2]], bool)> {
    let mut found: Vec<(std::ops::Range<usize>, bool)> = Vec::new();
    let mut from = 0;
    while from + 1 < points.len() {
        let to = (from + GROUP).min(points.len() - 1);
        let is_dense = (to - from) as f64 > points[to][0] - points[from][0];
        match found.last_mut() {
            Some((range, dense)) if *dense == is_dense => range.end = to + 1,
            _ => found.push((from..to + 1, is_dense)),
        }
        from = to;
    }
    found.into_iter().map(|(range, is_dense)| (&points[range], is_dense)).collect()
}

/// Parts of a line inside a rectangle with a small margin.
fn inside(points: &[[f64; 2]], clip: Rect) -> Vec<Vec<Pos2>> {
    let low = [f64::from(clip.left()) - BEYOND, f64::from(clip.top()) - BEYOND];
    let high = [f64::from(clip.right()) + BEYOND, f64::from(clip.bottom()) + BEYOND];
    let at = |a: [f64; 2], b: [f64; 2], share: f64| {
        pos2((a[0] + share * (b[0] - a[0])) as f32, (a[1] + share * (b[1] - a[1])) as f32)
    };
    let mut runs = Vec::new();
    let mut run: Vec<Pos2> = Vec::new();
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        // Liang and Barsky: the range of the segment's parameter that lies inside of all four edges.
        let [mut from, mut to] = [0.0_f64, 1.0];
        for k in 0..2 {
            let along = b[k] - a[k];
            let (enters, leaves) = ((low[k] - a[k]) / along, (high[k] - a[k]) / along);
            if along == 0.0 {
                if a[k] < low[k] || a[k] > high[k] {
                    to = -1.0;
                }
            } else {
                from = from.max(enters.min(leaves));
                to = to.min(enters.max(leaves));
            }
        }
        if from > to {
            runs.extend((run.len() > 1).then(|| std::mem::take(&mut run)));
            run.clear();
            continue;
        }
        if from > 0.0 || run.is_empty() {
            runs.extend((run.len() > 1).then(|| std::mem::take(&mut run)));
            run = vec![at(a, b, from)];
        }
        run.push(at(a, b, to));
        if to < 1.0 {
            runs.push(std::mem::take(&mut run));
        }
    }
    runs.extend((run.len() > 1).then_some(run));
    runs
}

#[cfg(test)]
mod tests;
