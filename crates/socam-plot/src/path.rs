//! Series as path data, short: tenths of a pixel, relative, and no more points than a screen shows.

use std::fmt::Write;

use super::{Frame, Mark, Series};

/// Ratio of a step to the median step above which it is a gap.
const GAP_STEPS: f64 = 8.0;

/// A joined line, interrupted at missing values and, in a trace, at gaps.
pub(super) fn line(series: &Series<'_>, frame: &Frame, columns: usize) -> String {
    let gap = if series.mark == Mark::Trace { GAP_STEPS * usual_step(series.x) } else { f64::INFINITY };
    let mut pen = Pen::default();
    let mut column = Column::default();
    let width = column_width(frame, columns);
    let mut last_x = f64::NEG_INFINITY;
    for (x, y) in series.x.iter().zip(series.y) {
        let Some((left, top)) = frame.place(*x, *y) else {
            column.draw(&mut pen);
            pen.lift();
            continue;
        };
        let interrupted = last_x.is_finite() && (x - last_x).abs() > gap;
        let index = (left / width).floor();
        if interrupted || !column.holds(index) {
            column.draw(&mut pen);
        }
        if interrupted {
            pen.lift();
        }
        column.add(index, left, top);
        last_x = *x;
    }
    column.draw(&mut pen);
    pen.path
}

/// Error bars.
pub(super) fn bars(series: &Series<'_>, frame: &Frame) -> String {
    let mut pen = Pen::default();
    for (index, (x, y)) in series.x.iter().zip(series.y).enumerate() {
        let spread = series.spread(index);
        if let (Some((left, top)), Some((_, bottom))) =
            (frame.place(*x, y + spread), frame.place(*x, y - spread))
            && spread > 0.0
        {
            pen.lift();
            pen.to(left, top);
            pen.to(left, bottom);
        }
    }
    pen.path
}

/// All dots of a series.
pub(super) fn dots(series: &Series<'_>, frame: &Frame) -> String {
    let places = series.x.iter().zip(series.y).filter_map(|(x, y)| frame.place(*x, *y));
    places.map(|(left, top)| dot(series.mark, left, top)).collect()
}

/// One dot.
pub(super) fn dot(mark: Mark, left: f64, top: f64) -> String {
    match mark {
        Mark::Squares => format!("M{:.1} {:.1}h5v5h-5z", left - 2.5, top - 2.5),
        Mark::Crosses => format!("M{:.1} {:.1}l7 7m0-7l-7 7", left - 3.5, top - 3.5),
        _ => format!("M{:.1} {top:.1}a3 3 0 1 0 6 0a3 3 0 1 0-6 0z", left - 3.0),
    }
}

/// The area between `y - spread` and `y + spread`, one piece for each range without missing values, clipped to the axes.
pub(super) fn band(series: &Series<'_>, frame: &Frame) -> String {
    let edges = series.x.iter().zip(series.y).enumerate().map(|(index, (x, y))| {
        let spread = series.spread(index);
        let low = frame.place(*x, y - spread).or_else(|| frame.bottom(*x));
        Some((frame.place(*x, y + spread)?, low?))
    });
    let edges: Vec<_> = edges.collect();
    let mut path = String::new();
    for piece in edges.split(Option::is_none).filter(|piece| piece.len() > 1) {
        let upper = piece.iter().flatten().map(|(upper, _)| upper);
        let lower = piece.iter().rev().flatten().map(|(_, lower)| lower);
        for (index, (left, top)) in upper.chain(lower).enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(path, "{}{left:.1} {top:.1}", if index == 0 { 'M' } else { 'L' });
        }
        path.push('z');
    }
    path
}

fn column_width(frame: &Frame, columns: usize) -> f64 {
    frame.x.length() / columns.max(1) as f64
}

/// Median of the steps.
fn usual_step(x: &[f64]) -> f64 {
    let mut steps: Vec<f64> =
        x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|s| s.is_finite()).collect();
    if steps.is_empty() {
        return f64::INFINITY;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The samples of one pixel column: first, lowest, highest and last.
#[derive(Debug, Default)]
struct Column {
    index: f64,
    points: usize,
    first: (f64, f64),
    last: (f64, f64),
    least: f64,
    most: f64,
    least_came_first: bool,
}

impl Column {
    fn holds(&self, index: f64) -> bool {
        self.points == 0 || self.index == index
    }

    fn add(&mut self, index: f64, left: f64, top: f64) {
        if self.points == 0 {
            *self = Self { index, points: 0, first: (left, top), least: top, most: top, ..Self::default() };
        }
        if top < self.least {
            (self.least, self.least_came_first) = (top, false);
        }
        if top > self.most {
            (self.most, self.least_came_first) = (top, true);
        }
        self.last = (left, top);
        self.points += 1;
    }

    fn draw(&mut self, pen: &mut Pen) {
        let middle = f64::midpoint(self.first.0, self.last.0);
        match self.points {
            0 => return,
            1 => pen.to(self.first.0, self.first.1),
            2 => {
                pen.to(self.first.0, self.first.1);
                pen.to(self.last.0, self.last.1);
            }
            _ if self.least_came_first => {
                pen.to(middle, self.least);
                pen.to(middle, self.most);
            }
            _ => {
                pen.to(middle, self.most);
                pen.to(middle, self.least);
            }
        }
        self.points = 0;
    }
}

/// Writes relative path data in tenths.
#[derive(Debug, Default)]
struct Pen {
    path: String,
    /// Current point, in tenths; `None` after the end of a part.
    at: Option<(i64, i64)>,
}

impl Pen {
    fn lift(&mut self) {
        self.at = None;
    }

    fn to(&mut self, left: f64, top: f64) {
        let (x, y) = ((10.0 * left).round() as i64, (10.0 * top).round() as i64);
        match self.at {
            // A line of length zero with round ends is a dot, so that a single sample is visible.
            None => {
                self.path.push('M');
                self.number(x, true);
                self.number(y, false);
                self.path.push_str("h0");
            }
            Some((last_x, last_y)) if last_x == x => {
                if last_y != y {
                    self.path.push('v');
                    self.number(y - last_y, true);
                }
            }
            Some((last_x, last_y)) => {
                self.path.push('l');
                self.number(x - last_x, true);
                self.number(y - last_y, false);
            }
        }
        self.at = Some((x, y));
    }

    /// Tenths as the shortest decimal: `-15` is `-1.5`, `3` is `.3`.
    fn number(&mut self, tenths: i64, first: bool) {
        if !first && tenths >= 0 {
            self.path.push(' ');
        }
        if tenths < 0 {
            self.path.push('-');
        }
        let (whole, part) = (tenths.unsigned_abs() / 10, tenths.unsigned_abs() % 10);
        // Writing to a string cannot fail.
        let _ = match (whole, part) {
            (whole, 0) => write!(self.path, "{whole}"),
            (0, part) => write!(self.path, ".{part}"),
            (whole, part) => write!(self.path, "{whole}.{part}"),
        };
    }
}
