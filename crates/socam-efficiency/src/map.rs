//! Efficiency over speed and torque as a picture: colours and lines of equal efficiency, and beside them how well it is known.
//!
//! Only what the recordings visited is coloured. A number outside would be a guess of the three laws, not a measurement.

use std::fmt::Write;

use crate::Efficiency;

/// Panels, in the units of the view box, which a screen shows at about a pixel each.
const PANEL: (f64, f64) = (330.0, 250.0);
const LEFT: f64 = 58.0;
const GAP: f64 = 106.0;
const TOP: f64 = 58.0;
const ROW: f64 = 350.0;
/// Cells of a panel.
const CELLS: (usize, usize) = (33, 25);
/// A cell is drawn where a moment lies within so many cells of it.
const REACH: f64 = 2.6;
/// From low to high: dark to light, in equal steps of lightness.
const COLOURS: [(f64, f64, f64); 6] = [
    (68.0, 1.0, 84.0),
    (65.0, 68.0, 135.0),
    (42.0, 120.0, 142.0),
    (34.0, 168.0, 132.0),
    (122.0, 209.0, 81.0),
    (253.0, 231.0, 37.0),
];

/// The map of one or more sections, one row each, on common scales. `names` are their titles.
#[must_use]
pub fn svg(sections: &[(&str, &Efficiency)]) -> String {
    let visited = || sections.iter().flat_map(|(_, efficiency)| &efficiency.visited);
    let most = |k: usize| round_up(visited().map(|point| point[k]).fold(1e-9, f64::max));
    let (speed, torque) = (most(0), most(1));
    let cells: Vec<Vec<Cell>> =
        sections.iter().map(|(_, efficiency)| cells(efficiency, speed, torque)).collect();
    let all = || cells.iter().flatten();
    let values = Scale::of(all().map(|cell| 100.0 * cell.efficiency), 5.0, 100.0);
    let halves = Scale::of(all().map(|cell| 100.0 * cell.half), 0.0, f64::INFINITY);
    let (width, height) = (LEFT + 2.0 * PANEL.0 + 2.0 * GAP, TOP + ROW * sections.len() as f64 - 20.0);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"#222\" role=\"img\" aria-label=\"efficiency over speed and torque\">\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>"
    );
    for (row, ((name, efficiency), cells)) in sections.iter().zip(&cells).enumerate() {
        let top = TOP + ROW * row as f64;
        let _ = write!(
            text,
            "<text x=\"{LEFT}\" y=\"{}\" font-size=\"15\" font-weight=\"600\">{}</text>",
            top - 34.0,
            escaped(name)
        );
        let right = LEFT + PANEL.0 + GAP;
        let value = |cell: &Cell| 100.0 * cell.efficiency;
        panel(&mut text, (LEFT, top), "Efficiency (%)", cells, &value, &values, (speed, torque));
        lines(&mut text, (LEFT, top), efficiency, cells, &values, (speed, torque));
        let half = |cell: &Cell| 100.0 * cell.half;
        panel(
            &mut text,
            (right, top),
            "95 % interval, to either side (points)",
            cells,
            &half,
            &halves,
            (speed, torque),
        );
        dots(&mut text, (right, top), efficiency, (speed, torque));
    }
    text.push_str("</svg>\n");
    text
}

struct Cell {
    column: usize,
    row: usize,
    efficiency: f64,
    half: f64,
}

fn cells(efficiency: &Efficiency, speed: f64, torque: f64) -> Vec<Cell> {
    let (columns, rows) = CELLS;
    let mut near = vec![false; columns * rows];
    for point in &efficiency.visited {
        let (x, y) = (point[0] / speed * columns as f64 - 0.5, point[1] / torque * rows as f64 - 0.5);
        for row in 0..rows {
            for column in 0..columns {
                near[row * columns + column] |= (x - column as f64).hypot(y - row as f64) < REACH;
            }
        }
    }
    let at = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let (x, y) = ((column as f64 + 0.5) / columns as f64, (row as f64 + 0.5) / rows as f64);
        let estimate = efficiency.losses.efficiency(x * speed, y * torque);
        Cell { column, row, efficiency: estimate.value, half: 0.5 * (estimate.ci95[1] - estimate.ci95[0]) }
    };
    // Next to no torque, all of it is lost, and colours would be spent on that.
    (0..columns * rows).filter(|index| near[*index]).map(at).filter(|cell| cell.efficiency > 0.3).collect()
}

/// Values to colours.
struct Scale {
    low: f64,
    high: f64,
    step: f64,
}

impl Scale {
    /// Nine tenths of the values, in round numbers: a few at the edge would take all colours.
    fn of(values: impl Iterator<Item = f64>, margin: f64, most: f64) -> Self {
        let mut sorted: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |part: f64| {
            sorted.get((part * (sorted.len().max(1) - 1) as f64) as usize).copied().unwrap_or(0.0)
        };
        let (low, high) = if margin > 0.0 { (at(0.08), at(1.0)) } else { (0.0, at(0.95)) };
        let step = round_step((high - low).max(1e-3) / 5.0);
        let low = (low / step).floor() * step;
        Self { low, high: ((high / step).ceil() * step).min(most).max(low + step), step }
    }

    fn colour(&self, value: f64) -> String {
        let share = ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        let place = share * (COLOURS.len() - 1) as f64;
        let index = (place as usize).min(COLOURS.len() - 2);
        let part = place - index as f64;
        let (a, b) = (COLOURS[index], COLOURS[index + 1]);
        let mix = |a: f64, b: f64| (a + part * (b - a)).round() as u8;
        format!("#{:02x}{:02x}{:02x}", mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
    }

    fn ticks(&self) -> Vec<f64> {
        let count = ((self.high - self.low) / self.step).round() as usize;
        (0..=count).map(|k| self.low + k as f64 * self.step).collect()
    }

    fn label(&self, value: f64) -> String {
        format!("{value:.*}", (-self.step.log10().floor()).max(0.0) as usize)
    }
}

fn panel(
    text: &mut String,
    (left, top): (f64, f64),
    title: &str,
    cells: &[Cell],
    value: &dyn Fn(&Cell) -> f64,
    scale: &Scale,
    (speed, torque): (f64, f64),
) {
    let (width, height) = PANEL;
    let (cell_width, cell_height) = (width / CELLS.0 as f64, height / CELLS.1 as f64);
    let _ = write!(text, "<text x=\"{left}\" y=\"{}\">{title}</text>", top - 12.0);
    let _ = write!(
        text,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"#f3f3f3\"/><g shape-rendering=\"crispEdges\">"
    );
    for cell in cells {
        let (x, y) =
            (left + cell.column as f64 * cell_width, top + height - (cell.row + 1) as f64 * cell_height);
        let _ = write!(
            text,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{cell_width:.1}\" height=\"{cell_height:.1}\" fill=\"{}\"/>",
            scale.colour(value(cell))
        );
    }
    text.push_str("</g>");
    axes(text, (left, top), (speed, torque));
    let bar = left + width + 14.0;
    let ticks = scale.ticks();
    for k in 0..50 {
        let share = f64::from(k) / 50.0;
        let colour = scale.colour(scale.low + (share + 0.01) * (scale.high - scale.low));
        let y = top + height * (1.0 - share - 0.02);
        let _ = write!(
            text,
            "<rect x=\"{bar}\" y=\"{y:.1}\" width=\"12\" height=\"{:.1}\" fill=\"{colour}\"/>",
            height / 50.0 + 0.5
        );
    }
    for tick in ticks {
        let y = top + height * (1.0 - (tick - scale.low) / (scale.high - scale.low)) + 4.0;
        let _ = write!(
            text,
            "<text x=\"{}\" y=\"{y:.1}\" font-size=\"11\">{}</text>",
            bar + 16.0,
            scale.label(tick)
        );
    }
}

fn axes(text: &mut String, (left, top): (f64, f64), (speed, torque): (f64, f64)) {
    let (width, height) = PANEL;
    let bottom = top + height;
    for (k, label) in ticks(speed) {
        let x = left + k / speed * width;
        let _ = write!(
            text,
            "<path d=\"M{x:.1} {bottom}v4\" stroke=\"#888\"/><text x=\"{x:.1}\" y=\"{}\" font-size=\"11\" text-anchor=\"middle\">{label}</text>",
            bottom + 17.0
        );
    }
    for (k, label) in ticks(torque) {
        let y = bottom - k / torque * height;
        let _ = write!(
            text,
            "<path d=\"M{left} {y:.1}h-4\" stroke=\"#888\"/><text x=\"{}\" y=\"{:.1}\" font-size=\"11\" text-anchor=\"end\">{label}</text>",
            left - 7.0,
            y + 4.0
        );
    }
    let (x, y) = (left - 42.0, top + 0.5 * height);
    let _ = write!(
        text,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">Input speed (rad/s)</text>\
         <text transform=\"translate({x} {y}) rotate(-90)\" text-anchor=\"middle\">Input torque (N m)</text>",
        left + 0.5 * width,
        bottom + 34.0
    );
}

/// Lines of equal efficiency, which the three laws make straight: torque = (viscous speed + constant) / (1 - share - efficiency).
fn lines(
    text: &mut String,
    (left, top): (f64, f64),
    efficiency: &Efficiency,
    cells: &[Cell],
    scale: &Scale,
    (speed, torque): (f64, f64),
) {
    let (width, height) = PANEL;
    let is_drawn = |x: f64, y: f64| {
        let (column, row) = ((x / speed * CELLS.0 as f64) as usize, (y / torque * CELLS.1 as f64) as usize);
        cells.iter().any(|cell| cell.column == column && cell.row == row)
    };
    let of = |estimate: &Option<socam_calibrate::Estimate>| estimate.map_or(0.0, |estimate| estimate.value);
    let losses = &efficiency.losses;
    for level in scale.ticks() {
        let room = 1.0 - of(&losses.torque_share) - 0.01 * level;
        let along = |x: f64| (of(&losses.viscous) * x + of(&losses.constant)) / room;
        let points: Vec<(f64, f64)> = (0..=120)
            .map(|k| f64::from(k) / 120.0 * speed)
            .map(|x| (x, along(x)))
            .filter(|(x, y)| *y > 0.0 && is_drawn(*x, *y))
            .collect();
        let place = |(x, y): (f64, f64)| (left + x / speed * width, top + height * (1.0 - y / torque));
        let Some(((x1, y1), (x2, y2))) =
            points.first().copied().map(place).zip(points.last().copied().map(place))
        else {
            continue;
        };
        if (x2 - x1).hypot(y2 - y1) < 24.0 {
            continue;
        }
        let (x, y) = (x1 + 0.7 * (x2 - x1), y1 + 0.7 * (y2 - y1));
        let _ = write!(
            text,
            "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" stroke=\"#fff\" stroke-width=\"1.2\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"11\" text-anchor=\"middle\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
            y + 4.0,
            scale.label(level)
        );
    }
}

/// Where the recordings were.
fn dots(text: &mut String, (left, top): (f64, f64), efficiency: &Efficiency, (speed, torque): (f64, f64)) {
    let (width, height) = PANEL;
    let every = efficiency.visited.len().div_ceil(400).max(1);
    text.push_str("<g fill=\"#fff\" fill-opacity=\"0.75\">");
    for point in efficiency.visited.iter().step_by(every) {
        let (x, y) = (left + point[0] / speed * width, top + height * (1.0 - point[1] / torque));
        let _ = write!(text, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"1.4\"/>");
    }
    text.push_str("</g>");
}

fn ticks(most: f64) -> Vec<(f64, String)> {
    let step = round_step(most / 5.0);
    let digits = (-step.log10().floor()).max(0.0) as usize;
    (0..=(most / step + 1e-9) as usize)
        .map(|k| k as f64 * step)
        .map(|value| (value, format!("{value:.digits$}")))
        .collect()
}

/// 1, 2 or 5 times a power of ten.
fn round_step(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0].into_iter().find(|factor| factor * decade >= 0.75 * step).unwrap_or(10.0) * decade
}

fn round_up(value: f64) -> f64 {
    let step = round_step(value / 10.0);
    (value / step).ceil() * step
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
