//! A line through its pairs as a picture, and beside it what is left: the one shows that it fits, the other how well.

use std::fmt::Write;

use crate::Line;

const PANEL: (f64, f64) = (320.0, 210.0);
const LEFT: f64 = 64.0;
const GAP: f64 = 86.0;
const TOP: f64 = 62.0;
const ROW: f64 = 306.0;

/// What a line is about.
#[derive(Debug, Clone, PartialEq)]
pub struct Titled<'a> {
    /// Title of its row.
    pub title: String,
    /// What it is over, with the unit.
    pub over: String,
    /// What it gives, with the unit.
    pub of: String,
    /// The line.
    pub line: &'a Line,
}

/// Lines, one row each.
#[must_use]
pub fn svg(lines: &[Titled<'_>]) -> String {
    let (width, height) = (LEFT + 2.0 * PANEL.0 + GAP + 20.0, TOP + ROW * lines.len() as f64 - 20.0);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"#222\"><rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>"
    );
    for (row, titled) in lines.iter().enumerate() {
        draw(&mut text, titled, TOP + ROW * row as f64);
    }
    text.push_str("</svg>\n");
    text
}

fn draw(text: &mut String, titled: &Titled<'_>, top: f64) {
    let line = titled.line;
    let _ = write!(
        text,
        "<text x=\"{LEFT}\" y=\"{}\" font-size=\"15\" font-weight=\"600\">{}</text>",
        top - 36.0,
        titled.title
    );
    let pairs = Frame::over(&line.pairs, (LEFT, top), true);
    pairs.axes(text, &titled.over, &titled.of);
    let ends = [pairs.x.0, pairs.x.1].map(|x| pairs.place([x, line.at(x)]));
    let _ = write!(
        text,
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#2166ac\" stroke-width=\"1.5\"/>",
        ends[0].0, ends[0].1, ends[1].0, ends[1].1
    );
    dots(text, &pairs, &line.pairs, &line.outliers);
    // Outliers would hide what the others are scattered by; they stand at the edge.
    let span = (line.gain.value * (line.range[1] - line.range[0])).abs().max(f64::MIN_POSITIVE);
    let left = |pair: &[f64; 2]| [pair[0], 100.0 * (pair[1] - line.at(pair[0])) / span];
    let inside = line.pairs.iter().enumerate().filter(|(row, _)| !line.outliers.contains(row));
    let residuals: Vec<[f64; 2]> = inside.map(|(_, pair)| left(pair)).collect();
    let frame = Frame::over(&residuals, (LEFT + PANEL.0 + GAP, top), false);
    frame.axes(text, &titled.over, "What is left (% of span)");
    let (zero, width) = (frame.place([0.0, 0.0]).1, PANEL.0);
    let _ = write!(text, "<path d=\"M{} {zero:.1}h{width}\" stroke=\"#2166ac\"/>", frame.at.0);
    dots(text, &frame, &residuals, &[]);
    let outliers: Vec<[f64; 2]> = line.outliers.iter().map(|row| left(&line.pairs[*row])).collect();
    for pair in &outliers {
        let (x, y) = frame.place([pair[0], pair[1].clamp(frame.y.0, frame.y.1)]);
        cross(text, x, y);
    }
    if !line.outliers.is_empty() {
        let _ = write!(
            text,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" fill=\"#b2182b\">\u{d7} does not belong to the others ({}), drawn at the edge</text>",
            LEFT + 2.0 * PANEL.0 + GAP,
            top - 30.0,
            line.outliers.len()
        );
    }
}

fn dots(text: &mut String, frame: &Frame, pairs: &[[f64; 2]], outliers: &[usize]) {
    for (row, pair) in pairs.iter().enumerate() {
        let (x, y) = frame.place(*pair);
        if outliers.contains(&row) {
            cross(text, x, y);
        } else {
            let _ =
                write!(text, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"none\" stroke=\"#222\"/>");
        }
    }
}

fn cross(text: &mut String, x: f64, y: f64) {
    let _ = write!(
        text,
        "<path d=\"M{:.1} {:.1}l8 8m0 -8l-8 8\" stroke=\"#b2182b\" stroke-width=\"1.6\"/>",
        x - 4.0,
        y - 4.0
    );
}

struct Frame {
    x: (f64, f64),
    y: (f64, f64),
    at: (f64, f64),
}

impl Frame {
    /// Round ends about all pairs; with `zero`, from zero where that is near.
    fn over(pairs: &[[f64; 2]], at: (f64, f64), zero: bool) -> Self {
        let range = |k: usize| {
            let (low, high) = pairs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), pair| {
                (low.min(pair[k]), high.max(pair[k]))
            });
            if low <= high { (low, high) } else { (0.0, 1.0) }
        };
        let rounded = |(low, high): (f64, f64), zero: bool| {
            let (low, high) = if zero && low > 0.0 && low < 0.5 * high { (0.0, high) } else { (low, high) };
            let step = step((high - low).max(1e-9));
            ((low / step).floor() * step, (high / step).ceil() * step)
        };
        let (low, high) = range(1);
        let y = if zero {
            rounded((low, high), true)
        } else {
            let size = low.abs().max(high.abs()).max(1e-6);
            rounded((-1.1 * size, 1.1 * size), false)
        };
        Self { x: rounded(range(0), true), y, at }
    }

    fn place(&self, pair: [f64; 2]) -> (f64, f64) {
        let share = |value: f64, (low, high): (f64, f64)| (value - low) / (high - low);
        (self.at.0 + PANEL.0 * share(pair[0], self.x), self.at.1 + PANEL.1 * (1.0 - share(pair[1], self.y)))
    }

    fn axes(&self, text: &mut String, over: &str, of: &str) {
        let (left, top) = self.at;
        let bottom = top + PANEL.1;
        for value in ticks(self.x) {
            let x = self.place([value, self.y.0]).0;
            let _ = write!(
                text,
                "<path d=\"M{x:.1} {top}V{bottom}\" stroke=\"#e4e4e4\"/><text x=\"{x:.1}\" y=\"{}\" font-size=\"11\" text-anchor=\"middle\">{}</text>",
                bottom + 16.0,
                label(value, self.x)
            );
        }
        for value in ticks(self.y) {
            let y = self.place([self.x.0, value]).1;
            let _ = write!(
                text,
                "<path d=\"M{left} {y:.1}h{}\" stroke=\"#e4e4e4\"/><text x=\"{}\" y=\"{:.1}\" font-size=\"11\" text-anchor=\"end\">{}</text>",
                PANEL.0,
                left - 6.0,
                y + 4.0,
                label(value, self.y)
            );
        }
        let (x, y) = (left + 0.5 * PANEL.0, bottom + 34.0);
        let _ = write!(
            text,
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{over}</text><text x=\"{left}\" y=\"{}\">{of}</text>",
            top - 12.0
        );
    }
}

fn step(range: f64) -> f64 {
    let raw = range / 5.0;
    let decade = 10_f64.powf(raw.log10().floor());
    [1.0, 2.0, 5.0].into_iter().find(|factor| factor * decade >= 0.75 * raw).unwrap_or(10.0) * decade
}

fn ticks((low, high): (f64, f64)) -> Vec<f64> {
    let step = step(high - low);
    (0..=((high - low) / step + 1e-9) as usize).map(|k| low + k as f64 * step).collect()
}

fn label(value: f64, (low, high): (f64, f64)) -> String {
    let digits = (-step(high - low).log10().floor()).max(0.0) as usize;
    let text = format!("{value:.digits$}").replace('-', "\u{2212}");
    if value.abs() < 1e-9 * (high - low) { format!("{:.digits$}", 0.0) } else { text }
}
