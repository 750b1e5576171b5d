//! Heat maps: a quantity over two others as colours, with a colour bar.

use std::fmt::Write;

use maud::{Markup, html};

use super::{Axis, BOTTOM, Frame, HEIGHT, TOP, WIDTH, axes, axis::Scale, usable};

/// Colours from low to high, in equal steps of lightness, which can be distinguished with any kind of colour blindness.
const COLOURS: [[f64; 3]; 6] = [
    [68.0, 1.0, 84.0],
    [65.0, 68.0, 135.0],
    [42.0, 120.0, 142.0],
    [34.0, 168.0, 132.0],
    [122.0, 209.0, 81.0],
    [253.0, 231.0, 37.0],
];
/// Room for the bar and its numbers.
pub(crate) const RIGHT: f64 = 70.0;
const BAR: f64 = 12.0;
/// Steps of the bar.
const STEPS: usize = 50;
/// Least length of a line with a number.
const LEAST_LINE: f64 = 24.0;
/// Greatest number of dots.
const MOST_DOTS: usize = 400;

/// One coloured field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Column from the left, from 0.
    pub column: usize,
    /// Row from below, from 0.
    pub row: usize,
    /// Value.
    pub value: f64,
}

/// A line of equal value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contour {
    /// Level of the contour, one of [`Heat::levels`].
    pub level: f64,
    /// Ends of the segment, in the units of the axes.
    pub ends: [[f64; 2]; 2],
}

/// Coloured cells over a pair of axes that begin at zero.
#[derive(Debug, Clone)]
pub struct Heat<'a> {
    /// Text for screen readers.
    pub title: String,
    /// Horizontal axis, and where it ends.
    pub x: (Axis, f64),
    /// Vertical axis, and where it ends.
    pub y: (Axis, f64),
    /// Quantity of the colours.
    pub value: Axis,
    /// Values of the first and the last colour; values beyond have these colours.
    pub colours: [f64; 2],
    /// Columns and rows.
    pub size: [usize; 2],
    /// Cells that have a value.
    pub cells: Vec<Cell>,
    /// Lines over the cells.
    pub contours: Vec<Contour>,
    /// Dots over the cells; only some of many are drawn.
    pub dots: &'a [[f64; 2]],
}

impl Heat<'_> {
    /// Values with a number beside the bar.
    #[must_use]
    pub fn levels(colours: [f64; 2]) -> Vec<f64> {
        bar(colours).levels().collect()
    }

    /// Contents of the view box; `None` without data.
    pub(super) fn drawn(&self) -> Option<Markup> {
        self.cells.iter().find(|cell| usable(cell.value))?;
        let y = self.y.0.exact([0.0, self.y.1], (HEIGHT - BOTTOM, TOP));
        let left = 26.0 + y.ticks().map(|tick| tick.width()).fold(38.0, f64::max);
        let right = WIDTH - RIGHT;
        let frame = Frame { x: self.x.0.exact([0.0, self.x.1], (left, right)), y, height: HEIGHT };
        let bar = bar(self.colours);
        let [columns, rows] = self.size.map(|count| count as f64);
        let (width, height) = ((right - left) / columns, (HEIGHT - BOTTOM - TOP) / rows);
        Some(html! {
            rect class="ground" x=(format!("{left:.1}")) y=(TOP) width=(format!("{:.1}", right - left)) height=(HEIGHT - BOTTOM - TOP) {}
            (axes([&self.x.0, &self.y.0], &frame, [left, right]))
            g shape-rendering="crispEdges" {
                @for cell in self.cells.iter().filter(|cell| usable(cell.value)) {
                    rect x=(format!("{:.1}", left + cell.column as f64 * width))
                        y=(format!("{:.1}", HEIGHT - BOTTOM - (cell.row + 1) as f64 * height))
                        width=(format!("{width:.1}")) height=(format!("{height:.1}")) fill=(written(bar.share(cell.value))) {}
                }
            }
            (self.lines(&frame, &bar))
            path class="speck" d=(self.specks(&frame)) {}
            (legend(&self.value, &bar, left, right))
        })
    }

    fn lines(&self, frame: &Frame, bar: &Scale) -> Markup {
        // Positions of the numbers so far.
        let mut taken: Vec<[f64; 2]> = Vec::new();
        let drawn = self.contours.iter().filter_map(|contour| {
            let [from, to] = contour.ends;
            let ((x1, y1), (x2, y2)) = (frame.place(from[0], from[1])?, frame.place(to[0], to[1])?);
            if (x2 - x1).hypot(y2 - y1) < LEAST_LINE {
                return None;
            }
            let tick = bar.levels().position(|level| level == contour.level)?;
            let at = [x1 + 0.7 * (x2 - x1), y1 + 0.7 * (y2 - y1)];
            let is_free = taken
                .iter()
                .all(|other| (other[0] - at[0]).abs() > LEAST_LINE || (other[1] - at[1]).abs() > 13.0);
            let label = is_free.then(|| bar.ticks().nth(tick)).flatten().map(|tick| tick.label);
            taken.extend(label.is_some().then_some(at));
            Some((format!("M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}"), at, label))
        });
        let drawn: Vec<_> = drawn.collect();
        html! {
            @for (path, ..) in &drawn { path class="contour" d=(path) {} }
            @for (_, [x, y], label) in &drawn {
                @if let Some(label) = label {
                    text class="halo" x=(format!("{x:.1}")) y=(format!("{:.1}", y + 4.0)) text-anchor="middle" { (label) }
                }
            }
        }
    }

    fn specks(&self, frame: &Frame) -> String {
        let every = self.dots.len().div_ceil(MOST_DOTS).max(1);
        let mut path = String::new();
        for [x, y] in self.dots.iter().step_by(every) {
            if let Some((x, y)) = frame.place(*x, *y) {
                // Writing to a string cannot fail.
                let _ = write!(path, "M{x:.1} {y:.1}h0");
            }
        }
        path
    }
}

/// The colour bar with its title.
pub(crate) fn legend(value: &Axis, bar: &Scale, left: f64, right: f64) -> Markup {
    let step = (HEIGHT - BOTTOM - TOP) / STEPS as f64;
    html! {
        text class="title" x=(format!("{left:.1}")) y="14" { (value.title(bar)) }
        @for k in 0..STEPS {
            rect x=(right + 12.0) y=(format!("{:.1}", HEIGHT - BOTTOM - (k + 1) as f64 * step)) width=(BAR)
                height=(format!("{:.1}", step + 0.5)) fill=(written((k as f64 + 0.5) / STEPS as f64)) {}
        }
        @for tick in bar.ticks() {
            text class="tick" x=(right + 12.0 + BAR + 5.0) y=(format!("{:.1}", tick.place + 3.5)) { (tick.label) }
        }
    }
}

pub(crate) fn bar(colours: [f64; 2]) -> Scale {
    Axis::new("", "").exact(colours, (HEIGHT - BOTTOM, TOP))
}

/// The colour, red, green and blue, of a value's share of the range, 0 to 1.
#[must_use]
pub fn colour(share: f64) -> [u8; 3] {
    let place = share.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let index = (place as usize).min(COLOURS.len() - 2);
    let part = place - index as f64;
    std::array::from_fn(|k| {
        (COLOURS[index][k] + part * (COLOURS[index + 1][k] - COLOURS[index][k])).round() as u8
    })
}

fn written(share: f64) -> String {
    let [red, green, blue] = colour(share);
    format!("#{red:02x}{green:02x}{blue:02x}")
}
