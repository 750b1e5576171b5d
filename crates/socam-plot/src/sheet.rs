//! Plots as SVG files of their own, one or several to a file.

use maud::{Markup, PreEscaped, html};

use crate::{HEIGHT, Heat, Plot, STYLE, WIDTH};

/// A plot of a [`Row`].
#[derive(Debug, Clone)]
pub enum Panel<'a> {
    /// Lines and points.
    Plot(Plot<'a>),
    /// Colours.
    Heat(Heat<'a>),
}

impl Panel<'_> {
    fn parts(&self) -> (&str, Option<Markup>) {
        match self {
            Self::Plot(plot) => (&plot.title, plot.drawn([WIDTH, HEIGHT])),
            Self::Heat(heat) => (&heat.title, heat.drawn()),
        }
    }
}

/// Plots side by side under a title.
#[derive(Debug, Clone)]
pub struct Row<'a> {
    /// Title.
    pub title: String,
    /// Panels from left to right.
    pub panels: Vec<Panel<'a>>,
}

/// A plot as a file of its own, in light colours.
#[must_use]
pub fn standalone(plot: &Plot<'_>) -> String {
    file([WIDTH, HEIGHT], &plot.title, &placed((&plot.title, plot.drawn([WIDTH, HEIGHT])), [0.0, 0.0]))
}

/// Rows of plots as one file, like [`standalone`].
#[must_use]
pub fn sheet(title: &str, rows: &[Row<'_>]) -> String {
    const HEAD: f64 = 34.0;
    let columns = rows.iter().map(|row| row.panels.len()).max().unwrap_or(0);
    let top = |row: usize| row as f64 * (HEAD + HEIGHT);
    let content = html! {
        @for (index, row) in rows.iter().enumerate() {
            text class="head" x="14" y=(top(index) + 24.0) { (row.title) }
            @for (column, panel) in row.panels.iter().enumerate() {
                (placed(panel.parts(), [column as f64 * WIDTH, top(index) + HEAD]))
            }
        }
    };
    file([WIDTH * columns as f64, top(rows.len())], title, &content)
}

fn placed((title, drawn): (&str, Option<Markup>), [left, top]: [f64; 2]) -> Markup {
    html! {
        g transform=(format!("translate({left} {top})")) {
            @if let Some(drawn) = drawn {
                (drawn)
            } @else {
                text class="tick" x=(WIDTH / 2.0) y=(HEIGHT / 2.0) text-anchor="middle" { (title) ": no data" }
            }
        }
    }
}

/// A drawing of another kind as one file, in light colours: its content is of the class `class`, and `style` is added to the style of plots.
///
/// Variables of the style sheet are replaced by their colours, since few programs that show SVG files support them.
#[must_use]
pub fn drawing(
    [width, height]: [f64; 2],
    title: &str,
    (class, style): (&str, &str),
    content: &Markup,
) -> String {
    let part = |from: &str, to: &str| {
        STYLE.split(from).nth(1).and_then(|rest| rest.split(to).next()).unwrap_or_default()
    };
    let colours = part(":root {", "}").split(';').filter_map(|line| line.split_once(':'));
    let plots = colours.fold(part("/* plots */", "@media").to_owned() + style, |style, (name, colour)| {
        style.replace(&format!("var({})", name.trim()), colour.trim())
    });
    let scale = if width > WIDTH { 1.0 } else { 2.0 };
    let markup = html! {
        svg xmlns="http://www.w3.org/2000/svg" class=(class) viewBox=(format!("0 0 {width} {height}"))
            width=(scale * width) height=(scale * height) role="img" aria-label=(title) {
            style { (PreEscaped("svg { font-family: system-ui, \"DejaVu Sans\", sans-serif; }")) (PreEscaped(plots)) }
            rect width="100%" height="100%" fill="#fff" {}
            (content)
        }
    };
    format!("{}\n", markup.into_string())
}

fn file(size: [f64; 2], title: &str, content: &Markup) -> String {
    drawing(size, title, ("plot", ""), content)
}
