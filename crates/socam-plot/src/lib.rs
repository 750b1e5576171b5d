//! Small plots as inline SVG: lines and points with error bars over linear or logarithmic axes.
//!
//! Colours, dark mode and fonts come from the page's style sheet ([`STYLE`]) by class name. Legends stand above
//! the axes, so that they never cover data. Crates that were looked at: `plotters` writes fixed colours (no dark mode) and an
//! element per dot, `poloto` has no logarithmic axes or error bars, `charming` needs JavaScript to be read.

mod axis;
mod heat;
mod path;
mod sheet;
mod view;
pub mod words;

#[cfg(test)]
mod tests;

use maud::{DOCTYPE, Markup, PreEscaped, Render, html};

pub use axis::Axis;
use axis::Scale;
pub use heat::{Cell, Contour, Heat, colour};
pub use sheet::{Panel, Row, drawing, sheet, standalone};
pub use view::{Flag, Image, View, views};

/// Style in which a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Joined points; drawn with the extremes of every pixel column, so that spikes stay visible.
    Line,
    /// Joined points as for [`Mark::Line`], interrupted where a recording has a gap.
    Trace,
    /// Round dots joined by a thin line, with bars of `spread` to either side.
    Circles,
    /// Squares joined by a thin line, with bars of `spread` to either side.
    Squares,
    /// Round dots without lines.
    Points,
    /// Crosses without lines.
    Crosses,
    /// The area `spread` to either side, below later series.
    Band,
}

/// A series.
#[derive(Debug, Clone)]
pub struct Series<'a> {
    /// Name in the legend; no entry if it is empty.
    pub label: &'a str,
    /// Class of the style sheet, which sets the colour.
    pub class: &'a str,
    /// Style in which the series is drawn.
    pub mark: Mark,
    /// Abscissas, in the unit of the axis.
    pub x: &'a [f64],
    /// NaN leaves a gap.
    pub y: &'a [f64],
    /// Half-width of bars; may be empty.
    pub spread: &'a [f64],
}

/// One pair of axes.
#[derive(Debug, Clone)]
pub struct Plot<'a> {
    /// Text for screen readers.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Drawn in this order, the last on top.
    pub series: Vec<Series<'a>>,
    /// Greatest number of pixel columns; fewer make smaller files.
    pub columns: usize,
}

/// Size of the whole plot in the units of its view box, which a screen shows at about a pixel each.
const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 230.0;
/// Width of a plot that has a page's width to itself.
const WIDE: f64 = 900.0;
const TOP: f64 = 26.0;
const BOTTOM: f64 = 40.0;
const RIGHT: f64 = 12.0;
/// Mean width of a character of the smallest text.
pub(crate) const CHARACTER_WIDTH: f64 = 6.2;
/// Values beyond this are not drawn; they would overflow the arithmetic of axes.
const LARGEST: f64 = 1e100;

/// Style sheet of pages with plots: colours for light and dark, text, tables, and what plots are drawn with. Series have the
/// classes `before`, `after`, `third` and `noise`.
pub const STYLE: &str = include_str!("style.css");

/// A self-contained HTML document: [`STYLE`], the page's own style, and `body`.
#[must_use]
pub fn document(title: &str, style: &str, body: &Markup) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(style)) }
            }
            body { (body) }
        }
    }
}

/// Pixel columns of a plot at full resolution.
pub const COLUMNS: usize = 350;

/// A value that can be drawn.
pub(crate) fn usable(value: f64) -> bool {
    value.is_finite() && value.abs() < LARGEST
}

impl Series<'_> {
    fn spread(&self, index: usize) -> f64 {
        self.spread.get(index).copied().filter(|spread| usable(*spread)).unwrap_or(0.0).abs()
    }

    /// All points that the axes must contain.
    fn extent(&self) -> impl Iterator<Item = (f64, f64)> {
        self.x.iter().zip(self.y).enumerate().flat_map(|(index, (x, y))| {
            let spread = self.spread(index);
            [(*x, y - spread), (*x, y + spread)]
        })
    }
}

/// Mapping from data to the view box.
struct Frame {
    x: Scale,
    y: Scale,
    /// Height of the view box.
    height: f64,
}

impl Frame {
    /// Position of a point; `None` if the axes cannot show it.
    fn place(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        Some((self.x.place(x)?, self.y.place(y)?))
    }

    /// The lower edge of the axes at `x`, where a logarithmic axis shows values that are not positive.
    fn bottom(&self, x: f64) -> Option<(f64, f64)> {
        Some((self.x.place(x)?, self.height - BOTTOM))
    }
}

impl Render for Plot<'_> {
    fn render(&self) -> Markup {
        self.svg("plot", [WIDTH, HEIGHT])
    }
}

impl Plot<'_> {
    /// The plot as wide as a page and of this height for wide screens, and once more for narrow ones: the style sheet shows the one that
    /// fits.
    #[must_use]
    pub fn large(&self, height: f64) -> Markup {
        html! { (self.svg("plot wide", [WIDE, height])) (self.svg("plot narrow", [WIDTH, HEIGHT])) }
    }

    fn svg(&self, class: &str, size: [f64; 2]) -> Markup {
        let [width, height] = size;
        html! {
            @if let Some(drawn) = self.drawn(size) {
                svg class=(class) viewBox=(format!("0 0 {width} {height}")) role="img" aria-label=(self.title) { (drawn) }
            } @else {
                p class="none" { (self.title) ": no data." }
            }
        }
    }

    /// Contents of the view box; `None` without data.
    fn drawn(&self, [width, height]: [f64; 2]) -> Option<Markup> {
        let points = || self.series.iter().flat_map(Series::extent).filter(|(x, y)| usable(*x) && usable(*y));
        points().next()?;
        let y = self.y.scale(points().map(|(_, y)| y), (height - BOTTOM, TOP));
        // Plots below each other share their left edge unless a label needs more room.
        let left = 26.0 + y.ticks().map(|tick| tick.width()).fold(38.0, f64::max);
        let x = self.x.scale(points().map(|(x, _)| x), (left, width - RIGHT));
        let frame = Frame { x, y, height };
        Some(html! {
            (axes([&self.x, &self.y], &frame, [left, width - RIGHT]))
            @for series in &self.series { (self.draw(series, &frame)) }
            (self.legend(left))
        })
    }

    /// One row above the axes.
    fn legend(&self, left: f64) -> Markup {
        let mut at = left;
        let entries = self.series.iter().filter(|series| !series.label.is_empty()).map(|series| {
            let from = at;
            at += 34.0 + CHARACTER_WIDTH * series.label.chars().count() as f64;
            (from, series)
        });
        html! {
            @for (from, series) in entries {
                (sample(series, from))
                text class="tick" x=(format!("{:.1}", from + 20.0)) y="14" { (series.label) }
            }
        }
    }

    fn draw(&self, series: &Series<'_>, frame: &Frame) -> Markup {
        match series.mark {
            Mark::Line | Mark::Trace => html! {
                path class=(format!("line {}", series.class)) d=(path::line(series, frame, self.columns)) {}
            },
            Mark::Circles | Mark::Squares => self.dots(series, frame),
            Mark::Points => {
                html! { path class=(format!("dot {}", series.class)) d=(path::dots(series, frame)) {} }
            }
            Mark::Crosses => {
                html! { path class=(format!("thin {}", series.class)) d=(path::dots(series, frame)) {} }
            }
            Mark::Band => {
                html! { path class=(format!("band {}", series.class)) d=(path::band(series, frame)) {} }
            }
        }
    }

    fn dots(&self, series: &Series<'_>, frame: &Frame) -> Markup {
        let class = series.class;
        html! {
            path class=(format!("thin {class}")) d=(path::line(series, frame, self.columns)) {}
            path class=(format!("thin {class}")) d=(path::bars(series, frame)) {}
            path class=(format!("dot {class}")) d=(path::dots(series, frame)) {}
        }
    }
}

/// Grid, ticks and titles of both axes.
fn axes([x, y]: [&Axis; 2], frame: &Frame, [left, right]: [f64; 2]) -> Markup {
    let bottom = frame.height - BOTTOM;
    let middle = f64::midpoint(TOP, bottom);
    html! {
        @for tick in frame.y.ticks() {
            path class=(if tick.is_zero { "zero" } else { "grid" }) d=(format!("M{left:.1} {:.1}H{right}", tick.place)) {}
            text class="tick" x=(format!("{:.1}", left - 5.0)) y=(format!("{:.1}", tick.place + 3.5)) text-anchor="end" { (tick.label) }
        }
        @for tick in frame.x.ticks() {
            path class="grid" d=(format!("M{:.1} {TOP}V{bottom}", tick.place)) {}
            text class="tick" x=(format!("{:.1}", tick.place)) y=(bottom + 14.0) text-anchor="middle" { (tick.label) }
        }
        path class="axis" d=(format!("M{left:.1} {TOP}V{bottom}H{right}")) {}
        text class="title" x=(format!("{:.1}", f64::midpoint(left, right))) y=(frame.height - 8.0) text-anchor="middle" {
            (x.title(&frame.x))
        }
        text class="title" transform=(format!("translate(11 {middle:.1}) rotate(-90)")) text-anchor="middle" {
            (y.title(&frame.y))
        }
    }
}

/// A series as its legend shows it.
fn sample(series: &Series<'_>, from: f64) -> Markup {
    let (x, y) = (from + 8.0, 10.0);
    let line = format!("M{from:.1} {y}h16");
    html! {
        @match series.mark {
            Mark::Line | Mark::Trace => { path class=(format!("line key {}", series.class)) d=(line) {} }
            Mark::Points => { path class=(format!("dot {}", series.class)) d=(path::dot(series.mark, x, y)) {} }
            Mark::Crosses => { path class=(format!("thin {}", series.class)) d=(path::dot(series.mark, x, y)) {} }
            Mark::Band => { path class=(format!("band {}", series.class)) d=(format!("M{from:.1} 6h16v8h-16z")) {} }
            Mark::Circles | Mark::Squares => {
                path class=(format!("thin {}", series.class)) d=(line) {}
                path class=(format!("dot {}", series.class)) d=(path::dot(series.mark, x, y)) {}
            }
        }
    }
}
