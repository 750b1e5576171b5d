//! Charts as a program shows them, below each other in one file: with given ranges, their own colours, and marks on the horizontal axis.

use maud::{Markup, html};

use crate::{
    Axis, BOTTOM, CHARACTER_WIDTH, Frame, HEIGHT, Plot, RIGHT, Series, TOP, axes, drawing, heat, sample,
};

/// Width of a chart in the units of its view box.
const WIDTH: f64 = 840.0;
/// Height of a row of the legend, and of the flags' texts.
const ROW: f64 = 16.0;
/// Greatest number of rows of the flags' texts; a text that has no room is the title of its line.
const FLAG_ROWS: usize = 3;

/// A marked position on the horizontal axis.
#[derive(Debug, Clone)]
pub struct Flag<'a> {
    /// Position.
    pub x: f64,
    /// Text; may be empty.
    pub text: &'a str,
    /// Class of the style sheet.
    pub class: String,
}

/// A picture over a part of the axes, below the lines.
#[derive(Debug, Clone)]
pub struct Image {
    /// Address of the image, such as a `data:` URL.
    pub href: String,
    /// Horizontal range.
    pub x: [f64; 2],
    /// Vertical range.
    pub y: [f64; 2],
}

/// A chart with given ranges; what leaves them is cut off.
#[derive(Debug, Clone)]
pub struct View<'a> {
    /// Axes and series.
    pub plot: Plot<'a>,
    /// Ranges of the horizontal and of the vertical axis.
    pub ranges: [[f64; 2]; 2],
    /// Shaded ranges of the horizontal axis, and their classes.
    pub shaded: Vec<([f64; 2], String)>,
    /// Vertical lines.
    pub flags: Vec<Flag<'a>>,
    /// A picture below the lines.
    pub image: Option<Image>,
    /// Quantity and range of a colour bar.
    pub bar: Option<(Axis, [f64; 2])>,
}

/// Charts below each other as one file, in light colours. `style` colours the classes; the class `dashed` dashes a line, and `wide`, `broad`
/// and `thin` are widths.
#[must_use]
pub fn views(title: &str, views: &[View<'_>], style: &str) -> String {
    // Charts below each other share their left edge.
    let left = views.iter().map(View::left).fold(0.0, f64::max);
    let mut top = 0.0;
    let mut placed = Vec::new();
    for (number, view) in views.iter().enumerate() {
        let (legend, rows) = view.legend(left);
        let below = top + ROW * rows.saturating_sub(1) as f64;
        placed.push((top, legend, below, view.drawn(left, number)));
        top = below + HEIGHT;
    }
    let content = html! {
        @for (top, legend, below, drawn) in &placed {
            g transform=(format!("translate(0 {top})")) { (legend) }
            g transform=(format!("translate(0 {below})")) { (drawn) }
        }
    };
    let style = format!(
        "{style} .plot .dashed {{ stroke-dasharray: 5 3; }} .plot .line.wide {{ stroke-width: 4; }} .plot .line.broad {{ stroke-width: 2.6; }} \
         .plot .line.thin {{ stroke-width: .7; }} .plot .flag {{ font-size: 10px; }} .plot .speckle {{ stroke-width: 2.2; }}"
    );
    drawing([WIDTH, top.max(1.0)], title, ("plot", &style), &content)
}

impl View<'_> {
    /// Left edge of the axes.
    fn left(&self) -> f64 {
        let y = self.plot.y.open(self.ranges[1], (HEIGHT - BOTTOM, TOP));
        26.0 + y.ticks().map(|tick| tick.width()).fold(38.0, f64::max)
    }

    fn right(&self) -> f64 {
        WIDTH - if self.bar.is_some() { heat::RIGHT } else { RIGHT }
    }

    fn drawn(&self, left: f64, number: usize) -> Markup {
        let right = self.right();
        let frame = Frame {
            x: self.plot.x.open(self.ranges[0], (left, right)),
            y: self.plot.y.open(self.ranges[1], (HEIGHT - BOTTOM, TOP)),
            height: HEIGHT,
        };
        let clip = format!("frame{number}");
        let (width, height) = (format!("{:.1}", right - left), HEIGHT - BOTTOM - TOP);
        html! {
            clipPath id=(clip) { rect x=(format!("{left:.1}")) y=(TOP) width=(width) height=(height) {} }
            (axes([&self.plot.x, &self.plot.y], &frame, [left, right]))
            g clip-path=(format!("url(#{clip})")) {
                @for (range, class) in &self.shaded { (shade(&frame, *range, class)) }
                @if let Some(image) = &self.image { (picture(&frame, image)) }
                @for series in &self.plot.series { (self.plot.draw(series, &frame)) }
                (self.flags(&frame))
            }
            @if let Some((axis, range)) = &self.bar { (heat::legend(axis, &heat::bar(*range), left, right)) }
        }
    }

    /// Names of the series above the axes, and their number of rows.
    fn legend(&self, left: f64) -> (Markup, usize) {
        let (mut at, mut rows) = (left, 1);
        let mut named: Vec<(f64, usize, &Series<'_>)> = Vec::new();
        for series in self.plot.series.iter().filter(|series| !series.label.is_empty()) {
            let width = 30.0 + CHARACTER_WIDTH * series.label.chars().count() as f64;
            if at > left && at + width > WIDTH {
                (at, rows) = (left, rows + 1);
            }
            named.push((at, rows - 1, series));
            at += width;
        }
        let markup = html! {
            @for (from, row, series) in named {
                g transform=(format!("translate(0 {})", ROW * row as f64)) {
                    (sample(series, from))
                    text class="tick" x=(format!("{:.1}", from + 20.0)) y="14" { (series.label) }
                }
            }
        };
        (markup, rows)
    }

    /// Lines of the flags with those texts that cover no other.
    fn flags(&self, frame: &Frame) -> Markup {
        let mut free = [f64::NEG_INFINITY; FLAG_ROWS];
        let drawn = self.flags.iter().filter_map(|flag| {
            let x = frame.x.place(flag.x)?;
            let row = free.iter().position(|free| *free <= x).filter(|_| !flag.text.is_empty());
            if let Some(row) = row {
                free[row] = x + 10.0 + CHARACTER_WIDTH * flag.text.chars().count() as f64;
            }
            Some((x, row, flag))
        });
        let drawn: Vec<_> = drawn.collect();
        html! {
            @for (x, row, flag) in drawn {
                g class=(format!("mark {}", flag.class)) {
                    @if !flag.text.is_empty() { title { (flag.text) } }
                    path d=(format!("M{x:.1} {TOP}V{}", HEIGHT - BOTTOM)) {}
                    @if let Some(row) = row {
                        text class="flag" x=(format!("{:.1}", x + 3.0)) y=(HEIGHT - BOTTOM - 4.0 - 12.0 * row as f64) { (flag.text) }
                    }
                }
            }
        }
    }
}

fn shade(frame: &Frame, [from, to]: [f64; 2], class: &str) -> Markup {
    let Some((from, to)) = frame.x.place(from).zip(frame.x.place(to)) else { return html! {} };
    html! {
        rect class=(format!("shade {class}")) x=(format!("{from:.1}")) y=(TOP) width=(format!("{:.1}", (to - from).max(1.0)))
            height=(HEIGHT - BOTTOM - TOP) {}
    }
}

fn picture(frame: &Frame, image: &Image) -> Markup {
    let corners = frame.place(image.x[0], image.y[0]).zip(frame.place(image.x[1], image.y[1]));
    let Some(((left, bottom), (right, top))) = corners else { return html! {} };
    html! {
        image x=(format!("{left:.1}")) y=(format!("{top:.1}")) width=(format!("{:.1}", (right - left).max(0.0)))
            height=(format!("{:.1}", (bottom - top).max(0.0))) preserveAspectRatio="none" href=(image.href) {}
    }
}
