//! Drawing of the bench: the layout of its model as SVG, with the places of findings and of competing models marked.
//!
//! Every element has its own cell, and labels are wrapped to the width of a cell, so that labels cannot overlap.

mod grid;
mod symbols;

use maud::{Markup, html};
use socam_model::{
    Model, Motion, Role,
    layout::{Element, ElementKind, Joint, Layout},
};

use grid::{BADGE, CELL, GROUNDED, LINE_HEIGHT, MARGIN, RowPosition, Rows, lines, middle, row_position};

/// Columns side by side: the whole default bench.
const COLUMNS: usize = 13;

/// Distance between the tracks of vertical wires.
const TRACK: f64 = 9.0;

/// A mark at an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PlaceMark {
    /// The finding of this number, from 1.
    Finding(usize),
    /// A place where a competing model of a finding acts.
    Rival,
}

/// Whether a competing model's mark is visible: its place is in the drawing and has no finding.
pub(super) fn shows_rivals(model: &Model, marks: &[(&str, PlaceMark)]) -> bool {
    let layout = Layout::of(model);
    let has_finding =
        |name: &str| marks.iter().any(|(other, mark)| *other == name && *mark != PlaceMark::Rival);
    marks
        .iter()
        .any(|(name, mark)| *mark == PlaceMark::Rival && layout.find(name).is_some() && !has_finding(name))
}

/// The bench with marks at places or channels by name. A name that the model does not have is left out.
pub(super) fn bench(model: &Model, marks: &[(&str, PlaceMark)]) -> Markup {
    let ([width, height], content) = drawn(model, marks);
    html! {
        svg class="bench" viewBox=(format!("0 0 {width} {height:.0}")) style=(format!("min-width:{:.0}px;max-width:{:.0}px", 0.72 * width, 1.1 * width))
            role="img" aria-label=(format!("Drawing of the bench {}", model.name)) { (content) }
    }
}

/// The bench as an SVG file of its own.
pub(super) fn file(model: &Model, style: &str, marks: &[(&str, PlaceMark)]) -> String {
    let (size, content) = drawn(model, marks);
    let own = style.lines().filter(|line| line.starts_with(".bench")).collect::<Vec<_>>().join("\n");
    socam_plot::drawing(size, &format!("Drawing of {}", model.name), ("bench", &own), &content)
}

/// Width and height, and the content.
fn drawn(model: &Model, marks: &[(&str, PlaceMark)]) -> ([f64; 2], Markup) {
    let layout = Layout::wrapped(model, COLUMNS);
    let rows = Rows::new(&layout);
    let (tracks, counts) = layout.tracks();
    let width = CELL * layout.columns as f64 + 2.0 * MARGIN;
    let marked = |element: &Element| {
        let of_it = || marks.iter().filter(|(name, _)| *name == element.name).map(|(_, mark)| *mark);
        let mut findings: Vec<_> = of_it().filter(|mark| *mark != PlaceMark::Rival).collect();
        findings.dedup();
        let rival = findings.is_empty() && of_it().next().is_some();
        (findings, rival)
    };
    let content = html! {
            @for element in &layout.elements {
                @let (findings, rival) = marked(element);
                (frame(element, &rows, &findings, rival))
            }
            @for (joint, track) in layout.joints.iter().zip(&tracks) {
                (wire(&layout, *joint, &rows, (*track, &counts)))
            }
            @for element in &layout.elements {
                (draw(element, &rows, model.motion))
            }
            @for element in &layout.elements {
                @let (findings, _) = marked(element);
                @for (place, mark) in findings.iter().enumerate() { (badge(element, &rows, place, *mark)) }
            }
    };
    ([width, rows.bottom().ceil()], content)
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
        kind if row_position(kind) == RowPosition::Grounded => html! {
            g transform=(format!("translate({x} {upper:.1})")) { (symbols::grounded(kind)) }
            (label(element, upper + GROUNDED, "name"))
        },
        kind => html! {
            (label(element, upper, "name"))
            g transform=(format!("translate({x} {:.1})", rows.wire(element))) { (symbols::chain(kind)) }
        },
    }
}

/// A line between two elements; `counts` is the number of tracks before each column.
fn wire(layout: &Layout, joint: Joint, rows: &Rows, (track, counts): (usize, &[usize])) -> Markup {
    let (Some(from), Some(to)) = (layout.elements.get(joint.from), layout.elements.get(joint.to)) else {
        return html! {};
    };
    let vertical = row_position(to.kind) != RowPosition::Chain || from.column == to.column;
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
        // The corner stands between cells, on its track.
        let off = track as f64 - 0.5 * counts[right.column].saturating_sub(1) as f64;
        let corner = middle(left) + 0.5 * CELL + TRACK * off;
        if y_start == y_end {
            format!("M{start:.1} {y_start:.1}H{end:.1}")
        } else {
            format!("M{start:.1} {y_start:.1}H{corner:.1}V{y_end:.1}H{end:.1}")
        }
    };
    html! { path class="wire" d=(d) {} }
}

/// The continuation of a wrapped chain: an arrow out of one line and one into the next.
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
fn frame(element: &Element, rows: &Rows, findings: &[PlaceMark], rival: bool) -> Markup {
    if findings.is_empty() && !rival {
        return html! {};
    }
    let (top, bottom) = (rows.upper(element) - 4.0, rows.lower(element) + 4.0);
    html! {
        rect class=(if rival { "mark rival" } else { "mark" }) x=(format!("{:.1}", middle(element) - 0.5 * CELL + 0.5))
            y=(format!("{top:.1}")) width=(CELL - 1.0) height=(format!("{:.1}", bottom - top)) rx="7" {}
    }
}

/// The numbered diamond of a finding, several in a row, on an edge of the frame without a label and away from the diamonds of frames above
/// and below.
fn badge(element: &Element, rows: &Rows, place_in_row: usize, mark: PlaceMark) -> Markup {
    let PlaceMark::Finding(number) = mark else {
        return html! {};
    };
    let along = 0.5 * CELL - 4.0 - (2.0 * BADGE + 1.0) * place_in_row as f64;
    let (x, y) = match row_position(element.kind) {
        RowPosition::Sensor => (middle(element) + along, rows.upper(element) - BADGE),
        RowPosition::Chain => (middle(element) + along, rows.lower(element) + 4.0),
        RowPosition::Grounded => (middle(element) - along, rows.upper(element)),
    };
    html! {
        g transform=(format!("translate({x:.1} {y:.1})")) { (diamond(number)) }
    }
}
