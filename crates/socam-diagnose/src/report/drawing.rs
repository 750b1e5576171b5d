//! The bench's drawing: the layout of its model as SVG, with the places of findings and of their rivals marked.
//!
//! Every element has a cell of its own, and every label is broken to the width of its cell, so labels cannot overlap.

mod symbols;

use maud::{Markup, html};
use socam_model::{
    Model, Motion, Role,
    layout::{Element, ElementKind, Joint, Layout},
};

/// Columns side by side: the whole default bench.
const COLUMNS: usize = 13;
/// Width of a cell in the units of the view box.
const CELL: f64 = 88.0;
/// Characters of a label's line that surely fit in a cell.
const LINE_CHARACTERS: usize = 12;
const LINE_HEIGHT: f64 = 13.0;
/// Height of a symbol of the chain, and of what hangs below.
const SYMBOL: f64 = 60.0;
const GROUNDED: f64 = 46.0;
/// Between rows.
const SPACE: f64 = 12.0;
/// Half the height of a finding's diamond.
const BADGE: f64 = 10.0;
/// For the stubs of a wrapped chain.
const MARGIN: f64 = 18.0;

/// What is pointed at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    /// The finding of this number, from 1.
    Finding(usize),
    /// A place where a rival of a finding acts.
    Rival,
}

/// Whether a rival's mark is to be seen: its place is in the drawing and has no finding of its own.
pub(super) fn shows_rivals(model: &Model, marks: &[(&str, Mark)]) -> bool {
    let layout = Layout::of(model);
    let has_finding = |name: &str| marks.iter().any(|(other, mark)| *other == name && *mark != Mark::Rival);
    marks.iter().any(|(name, mark)| *mark == Mark::Rival && layout.find(name).is_some() && !has_finding(name))
}

/// The bench with marks at places or channels by name. A name that the model does not have is left out.
pub(super) fn bench(model: &Model, marks: &[(&str, Mark)]) -> Markup {
    let layout = Layout::wrapped(model, COLUMNS);
    let rows = Rows::new(&layout);
    let width = CELL * layout.columns as f64 + 2.0 * MARGIN;
    let height = rows.bottom();
    let marked = |element: &Element| {
        let of_it = || marks.iter().filter(|(name, _)| *name == element.name).map(|(_, mark)| *mark);
        let mut findings: Vec<_> = of_it().filter(|mark| *mark != Mark::Rival).collect();
        findings.dedup();
        let rival = findings.is_empty() && of_it().next().is_some();
        (findings, rival)
    };
    html! {
        svg class="bench" viewBox=(format!("0 0 {width} {height:.0}")) style=(format!("min-width:{:.0}px;max-width:{:.0}px", 0.72 * width, 1.1 * width))
            role="img" aria-label=(format!("Drawing of the bench {}", model.name)) {
            @for element in &layout.elements {
                @let (findings, rival) = marked(element);
                (frame(element, &rows, &findings, rival))
            }
            @for joint in &layout.joints { (wire(&layout, *joint, &rows)) }
            @for element in &layout.elements {
                (draw(element, &rows, model.motion))
            }
            @for element in &layout.elements {
                @let (findings, _) = marked(element);
                @for (place, mark) in findings.iter().enumerate() { (badge(element, &rows, place, *mark)) }
            }
        }
    }
}

/// The marker of a finding as it stands in the drawing, to name it elsewhere.
pub(super) fn marker(number: usize) -> Markup {
    html! {
        svg class="marker" viewBox="-11 -11 22 22" aria-hidden="true" { (diamond(number)) }
    }
}

fn diamond(number: usize) -> Markup {
    html! {
        path class="diamond" d="M0-10L10 0 0 10-10 0z" {}
        text class="number" y="4" text-anchor="middle" { (number) }
    }
}

/// Heights of the grid's rows.
struct Rows {
    /// Top of each row, and the bottom of the last.
    tops: Vec<f64>,
    /// Height of the labels above the symbols of each row.
    labels: Vec<f64>,
}

impl Rows {
    fn new(layout: &Layout) -> Self {
        // A badge may stand above the first row.
        let mut tops = vec![SPACE + BADGE];
        let mut labels = Vec::new();
        for row in 0..layout.rows {
            let there = || layout.elements.iter().filter(|element| element.row == row);
            let text = there().map(|element| LINE_HEIGHT * lines(element).len() as f64).fold(0.0, f64::max);
            let symbol = there().map(symbol_height).fold(0.0, f64::max);
            let top = tops.last().copied().unwrap_or_default();
            labels.push(text);
            tops.push(top + text + symbol + SPACE);
        }
        Self { tops, labels }
    }

    fn bottom(&self) -> f64 {
        self.tops.last().copied().unwrap_or_default()
    }

    fn top(&self, element: &Element) -> f64 {
        self.tops[element.row]
    }

    /// Where the symbol of an element is: middle across, and the height of the wire that runs through it.
    fn wire(&self, element: &Element) -> f64 {
        self.top(element) + self.labels[element.row] + 0.5 * SYMBOL
    }

    /// Lower edge of what an element is made of.
    fn lower(&self, element: &Element) -> f64 {
        match place(element.kind) {
            Place::Sensor => self.tops[element.row + 1] - SPACE,
            Place::Chain => self.wire(element) + symbols::reach(element.kind),
            Place::Grounded => self.top(element) + GROUNDED + LINE_HEIGHT * lines(element).len() as f64,
        }
    }

    /// Upper edge of what an element is made of.
    fn upper(&self, element: &Element) -> f64 {
        let text = LINE_HEIGHT * lines(element).len() as f64;
        match place(element.kind) {
            Place::Sensor => self.lower(element) - text - 8.0,
            Place::Chain => self.top(element) + self.labels[element.row] - text,
            Place::Grounded => self.top(element),
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Sensor,
    Chain,
    Grounded,
}

fn place(kind: ElementKind) -> Place {
    match kind {
        ElementKind::Sensor { .. } => Place::Sensor,
        ElementKind::Bearing { .. } | ElementKind::GroundSpring { .. } => Place::Grounded,
        _ => Place::Chain,
    }
}

fn symbol_height(element: &Element) -> f64 {
    match place(element.kind) {
        Place::Sensor => 8.0,
        Place::Chain => SYMBOL,
        Place::Grounded => GROUNDED,
    }
}

fn middle(element: &Element) -> f64 {
    MARGIN + CELL * (element.column as f64 + 0.5)
}

/// The name, and the effects that the model has there, in lines that fit a cell.
fn lines(element: &Element) -> Vec<String> {
    let mut lines = wrap(&element.name);
    for effect in &element.effects {
        lines.extend(wrap(&format!("+ {effect}")));
    }
    lines
}

/// Breaks a name behind underscores and spaces, and in the middle of a word only where that alone is too long.
fn wrap(name: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in name.split_inclusive(['_', ' ', '-', '.']) {
        let mut rest: Vec<char> = word.chars().collect();
        while !rest.is_empty() {
            let used = lines.last().map_or(0, |line| line.chars().count());
            if used > 0 && used + rest.len() > LINE_CHARACTERS {
                lines.push(String::new());
                continue;
            }
            let fits = rest.len().min(LINE_CHARACTERS);
            if let Some(line) = lines.last_mut() {
                line.extend(rest.drain(..fits));
            }
        }
    }
    lines
}

fn label(element: &Element, top: f64, class: &str) -> Markup {
    let x = middle(element);
    html! {
        @for (index, line) in lines(element).iter().enumerate() {
            text class=(class) x=(x) y=(format!("{:.1}", top + LINE_HEIGHT * (index as f64 + 1.0) - 3.0)) text-anchor="middle" {
                (line)
            }
        }
    }
}

fn draw(element: &Element, rows: &Rows, motion: Motion) -> Markup {
    let x = middle(element);
    let upper = rows.upper(element);
    match element.kind {
        ElementKind::Sensor { role, quantity } => html! {
            rect class=(if role == Role::Input { "channel input" } else { "channel" }) x=(x - 0.5 * CELL + 2.0) y=(format!("{upper:.1}"))
                width=(CELL - 4.0) height=(format!("{:.1}", rows.lower(element) - upper)) rx="5" {
                title { (symbols::measures(quantity, role, motion)) }
            }
            (label(element, upper + 3.0, if role == Role::Input { "said-inside" } else { "said" }))
        },
        kind if place(kind) == Place::Grounded => html! {
            g transform=(format!("translate({x} {upper:.1})")) { (symbols::grounded(kind)) }
            (label(element, upper + GROUNDED, "name"))
        },
        kind => html! {
            (label(element, upper, "name"))
            g transform=(format!("translate({x} {:.1})", rows.wire(element))) { (symbols::chain(kind)) }
        },
    }
}

/// A line between two elements.
fn wire(layout: &Layout, joint: Joint, rows: &Rows) -> Markup {
    let (Some(from), Some(to)) = (layout.elements.get(joint.from), layout.elements.get(joint.to)) else {
        return html! {};
    };
    let vertical = place(to.kind) != Place::Chain || from.column == to.column;
    let d = if vertical {
        let x = middle(from);
        let (upper, lower) = if to.row < from.row { (to, from) } else { (from, to) };
        format!("M{x} {:.1}V{:.1}", rows.lower(upper), rows.upper(lower))
    } else if from.line != to.line {
        return continuation(from, to, rows);
    } else {
        let (y_from, y_to) = (rows.wire(from), rows.wire(to));
        let (left, right) = if from.column < to.column { (from, to) } else { (to, from) };
        let (start, end) =
            (middle(left) + symbols::half_width(left.kind), middle(right) - symbols::half_width(right.kind));
        let (y_start, y_end) = if from.column < to.column { (y_from, y_to) } else { (y_to, y_from) };
        // The corner stands between cells: beside the end from which a branch leaves.
        let corner = if y_start < y_end { middle(left) + 0.5 * CELL } else { middle(right) - 0.5 * CELL };
        if y_start == y_end {
            format!("M{start:.1} {y_start:.1}H{end:.1}")
        } else {
            format!("M{start:.1} {y_start:.1}H{corner:.1}V{y_end:.1}H{end:.1}")
        }
    };
    html! { path class="wire" d=(d) {} }
}

/// A wrapped chain goes on: an arrow out of one line and into the next.
fn continuation(from: &Element, to: &Element, rows: &Rows) -> Markup {
    let (out_of, into) =
        (middle(from) + symbols::half_width(from.kind), middle(to) - symbols::half_width(to.kind));
    let (end, start) = (middle(from) + 0.5 * CELL + 4.0, middle(to) - 0.5 * CELL - 12.0);
    let arrow = |x: f64, y: f64| format!("M{x:.1} {:.1}l8 4.5-8 4.5z", y - 4.5);
    let (y_out, y_in) = (rows.wire(from), rows.wire(to));
    html! {
        path class="wire" d=(format!("M{out_of:.1} {y_out:.1}H{end:.1}M{start:.1} {y_in:.1}H{into:.1}")) {}
        path class="solid" d=(arrow(end, y_out)) {}
        path class="solid" d=(arrow(start, y_in)) {}
    }
}

/// The box around a marked element.
fn frame(element: &Element, rows: &Rows, findings: &[Mark], rival: bool) -> Markup {
    if findings.is_empty() && !rival {
        return html! {};
    }
    let (top, bottom) = (rows.upper(element) - 4.0, rows.lower(element) + 4.0);
    html! {
        rect class=(if rival { "mark rival" } else { "mark" }) x=(format!("{:.1}", middle(element) - 0.5 * CELL + 0.5))
            y=(format!("{top:.1}")) width=(CELL - 1.0) height=(format!("{:.1}", bottom - top)) rx="7" {}
    }
}

/// The numbered diamond at a finding's place, several in a row, on an edge of the frame where no label is and no frame above
/// or below has its own.
fn badge(element: &Element, rows: &Rows, place_in_row: usize, mark: Mark) -> Markup {
    let Mark::Finding(number) = mark else {
        return html! {};
    };
    let along = 0.5 * CELL - 4.0 - (2.0 * BADGE + 1.0) * place_in_row as f64;
    let (x, y) = match place(element.kind) {
        Place::Sensor => (middle(element) + along, rows.upper(element) - BADGE),
        Place::Chain => (middle(element) + along, rows.lower(element) + 4.0),
        Place::Grounded => (middle(element) - along, rows.upper(element)),
    };
    html! {
        g transform=(format!("translate({x:.1} {y:.1})")) { (diamond(number)) }
    }
}
