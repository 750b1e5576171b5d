//! The bench as SVG: shapes of [`socam_model::drawing`], with colours and fonts by class from the page's style sheet.

use std::fmt::Write;

use maud::{Markup, html};
use socam_model::{
    Model,
    drawing::{Drawing, Item, Paint, PlaceMark, Point, Shape, Style, diamond},
};

/// The style sheet of pages that draw a bench; the rules of the drawing begin with `.bench`.
pub(crate) const STYLE: &str = include_str!("diagnosis/style.css");

/// The drawing on a wide screen, and on a narrow one, where the chain is wrapped.
const STYLES: [(&str, Style); 2] = [
    ("bench wide", Style { columns: 13, column_width: 88.0 }),
    ("bench narrow", Style { columns: 4, column_width: 84.0 }),
];

/// The bench with marks at places or channels by name, for wide and for narrow screens.
pub(crate) fn bench(model: &Model, marks: &[(&str, PlaceMark)]) -> Markup {
    html! {
        @for (class, style) in STYLES {
            @let drawing = Drawing::of(model, marks, style);
            @let [width, height] = drawing.size;
            svg class=(class) viewBox=(format!("0 0 {width} {height}")) style=(format!("max-width:{:.0}px", 1.1 * width))
                role="img" aria-label=(format!("Drawing of the bench {}", model.name)) { (content(&drawing)) }
        }
    }
}

/// The bench as an SVG file in light colours, with marks at places or channels by name: [`marks`](socam_findings::headline::marks) gives those
/// of a diagnosis.
///
/// ```
/// let model = socam_model::Model::builtin("two-mass").expect("an embedded model");
/// assert!(socam_report::bench::svg(&model, &[]).starts_with("<svg"));
/// ```
#[must_use]
pub fn svg(model: &Model, marks: &[(&str, PlaceMark)]) -> String {
    let drawing = Drawing::of(model, marks, Style::default());
    let own = STYLE.lines().filter(|line| line.starts_with(".bench")).collect::<Vec<_>>().join("\n");
    let title = format!("Drawing of {}", model.name);
    socam_plot::drawing(drawing.size, &title, ("bench", &own), &content(&drawing))
}

/// The marker of a finding as it stands in the drawing, to name it elsewhere.
pub(crate) fn marker(number: usize) -> Markup {
    html! {
        svg class="bench marker" viewBox="-11 -11 22 22" aria-hidden="true" { (shapes(&diamond([0.0, 0.0], number))) }
    }
}

fn content(drawing: &Drawing) -> Markup {
    html! {
        (shapes(&drawing.items))
        @for place in &drawing.places {
            @let [[left, top], [right, bottom]] = [place.from, place.to];
            rect class="place" x=(tenths(left)) y=(tenths(top)) width=(tenths(right - left)) height=(tenths(bottom - top)) {
                title { (place.hint) }
            }
        }
    }
}

fn shapes(items: &[Item]) -> Markup {
    html! {
        @for Item { paint, shape } in items {
            @match shape {
                Shape::Line(points) => { path class=(class(*paint)) d=(path(points)) {} }
                Shape::Polygon(points) => { path class=(class(*paint)) d=(path(points) + "z") {} }
                Shape::Rect { from, to, corner } => {
                    rect class=(class(*paint)) x=(tenths(from[0])) y=(tenths(from[1])) width=(tenths(to[0] - from[0]))
                        height=(tenths(to[1] - from[1])) rx=(corner) {}
                }
                Shape::Circle { centre, radius } => {
                    circle class=(class(*paint)) cx=(tenths(centre[0])) cy=(tenths(centre[1])) r=(radius) {}
                }
                Shape::Text { at, text } => {
                    text class=(class(*paint)) x=(tenths(at[0])) y=(tenths(at[1])) text-anchor="middle" { (text) }
                }
            }
        }
    }
}

/// The class of the style sheet that colours a shape.
fn class(paint: Paint) -> &'static str {
    match paint {
        Paint::Wire => "wire",
        Paint::Outline => "shape",
        Paint::Body => "body",
        Paint::Teeth => "teeth",
        Paint::Solid => "solid",
        Paint::Output => "channel",
        Paint::Input => "channel input",
        Paint::Finding => "mark",
        Paint::Rival => "mark rival",
        Paint::Diamond => "diamond",
        Paint::Name => "name",
        Paint::Letter => "letter",
        Paint::OutputName => "said",
        Paint::InputName => "said-inside",
        Paint::Number => "number",
    }
}

fn path(points: &[Point]) -> String {
    let mut path = String::new();
    for (index, [x, y]) in points.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(path, "{}{} {}", if index == 0 { 'M' } else { 'L' }, tenths(*x), tenths(*y));
    }
    path
}

/// A length to a tenth, as short as it goes.
fn tenths(length: f64) -> String {
    let text = format!("{length:.1}");
    let text = text.strip_suffix(".0").unwrap_or(&text);
    if text == "-0" { "0".into() } else { text.into() }
}
