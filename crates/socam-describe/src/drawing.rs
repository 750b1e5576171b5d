//! A model's drawing as text.

use socam_model::{
    Model, Role,
    layout::{Element, ElementKind, Layout},
};

/// Directions in which a wire leaves a gap between two columns.
const LEFT: u8 = 1;
const RIGHT: u8 = 2;
const UP: u8 = 4;
const DOWN: u8 = 8;

/// Draws a model in lines of at most `width` characters, where no name is longer: its elements in a row, sensors above and what holds
/// it below, branches in rows of their own. A long chain continues in further rows, marked by arrows.
///
/// ```
/// let model = socam_model::Model::builtin("two-mass").expect("an embedded model");
/// let drawing = socam_describe::draw(&model, 80);
/// assert!(drawing.contains("[motor]──────~shaft~──────[load]"), "{drawing}");
/// ```
#[must_use]
pub fn draw(model: &Model, width: usize) -> String {
    let most = Layout::of(model).columns;
    let fitting = (1..=most).rev().map(|columns| Grid::new(Layout::wrapped(model, columns)));
    let mut narrowest = None;
    for grid in fitting {
        if grid.width() <= width {
            return grid.text();
        }
        narrowest = Some(grid);
    }
    narrowest.map_or_else(String::new, |grid| grid.text())
}

/// The kinds of symbols in a drawing, explained.
#[must_use]
pub fn legend() -> &'static str {
    "[inertia]  (massless node)  ~spring~  <gear>  =rigid shaft=  {winding, servo}  \u{25bc} drives  \u{25b3} is measured  \u{2534} to the frame  * has effects"
}

struct Grid {
    layout: Layout,
    /// Width of each column.
    widths: Vec<usize>,
    /// Directions of the wires at the gap behind each column, by row.
    gaps: Vec<Vec<u8>>,
}

impl Grid {
    fn new(layout: Layout) -> Self {
        let width = |column: usize| {
            let own = layout.elements.iter().filter(|element| element.column == column);
            own.map(|element| label(element).chars().count()).max().unwrap_or(0)
        };
        let widths = (0..layout.columns).map(width).collect();
        let mut gaps = vec![vec![0; layout.columns + 1]; layout.rows];
        for joint in &layout.joints {
            let (a, b) = (&layout.elements[joint.from], &layout.elements[joint.to]);
            if a.line != b.line {
                // The chain continues in another line.
                let (first, second) = if a.line < b.line { (a, b) } else { (b, a) };
                gaps[first.row][first.column + 1] |= LEFT;
                gaps[second.row][second.column] |= RIGHT;
                continue;
            }
            let (left, right) = if a.column < b.column { (a, b) } else { (b, a) };
            if left.column == right.column {
                continue;
            }
            let gap = right.column;
            gaps[left.row][gap] |= LEFT;
            gaps[right.row][gap] |= RIGHT;
            let (top, bottom) = (left.row.min(right.row), left.row.max(right.row));
            for (row, cells) in gaps.iter_mut().enumerate().take(bottom + 1).skip(top) {
                cells[gap] |= if row > top { UP } else { 0 } | if row < bottom { DOWN } else { 0 };
            }
        }
        Self { layout, widths, gaps }
    }

    fn width(&self) -> usize {
        self.widths.iter().sum::<usize>() + 2 * (self.layout.columns + 1)
    }

    fn text(&self) -> String {
        let mut text = String::new();
        for row in 0..self.layout.rows {
            let mut line = String::new();
            for column in 0..=self.layout.columns {
                line.push_str(&self.gap(row, column));
                if column < self.layout.columns {
                    line.push_str(&self.cell(row, column));
                }
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }

    fn at(&self, row: usize, column: usize) -> Option<&Element> {
        self.layout.elements.iter().find(|element| element.row == row && element.column == column)
    }

    fn cell(&self, row: usize, column: usize) -> String {
        let width = self.widths[column];
        let Some(element) = self.at(row, column) else { return " ".repeat(width) };
        let label = label(element);
        let free = width - label.chars().count();
        let (before, after) = (free / 2, free - free / 2);
        let wire = |leaves: bool| if leaves { "\u{2500}" } else { " " };
        let into = wire(self.gaps[row][column] & RIGHT != 0 && is_chain(element.kind));
        let out = wire(self.gaps[row][column + 1] & LEFT != 0 && is_chain(element.kind));
        format!("{}{label}{}", into.repeat(before), out.repeat(after))
    }

    /// Two characters between columns.
    fn gap(&self, row: usize, column: usize) -> String {
        let ways = self.gaps[row][column];
        let continues =
            |there: bool, arrow: &str| if there { format!("\u{2500}{arrow}") } else { String::new() };
        if column == self.layout.columns || column == 0 {
            // The chain continues from or in another line.
            let text = continues(ways & LEFT != 0 && column > 0, "\u{2192}");
            let text = if column == 0 && ways & RIGHT != 0 { "\u{2192}\u{2500}".into() } else { text };
            return format!("{text:<2}");
        }
        let corner = match ways & (LEFT | RIGHT | UP | DOWN) {
            0 => ' ',
            w if w == LEFT | RIGHT || w == LEFT || w == RIGHT => '\u{2500}',
            w if w == UP | DOWN => '\u{2502}',
            w if w == LEFT | DOWN => '\u{2510}',
            w if w == RIGHT | DOWN => '\u{250c}',
            w if w == LEFT | UP => '\u{2518}',
            w if w == RIGHT | UP => '\u{2514}',
            w if w == LEFT | RIGHT | DOWN => '\u{252c}',
            w if w == LEFT | RIGHT | UP => '\u{2534}',
            w if w == RIGHT | UP | DOWN => '\u{251c}',
            w if w == LEFT | UP | DOWN => '\u{2524}',
            _ => '\u{253c}',
        };
        let behind = if ways & RIGHT != 0 { '\u{2500}' } else { ' ' };
        format!("{corner}{behind}")
    }
}

fn is_chain(kind: ElementKind) -> bool {
    !matches!(
        kind,
        ElementKind::Sensor { .. } | ElementKind::Bearing { .. } | ElementKind::GroundSpring { .. }
    )
}

fn label(element: &Element) -> String {
    let name = &element.name;
    let mark = if element.effects.is_empty() { "" } else { "*" };
    let number = |value: f64| format!("{}", (1e4 * value).round() / 1e4);
    match element.kind {
        ElementKind::Motor | ElementKind::Inertia | ElementKind::Load => format!("[{name}{mark}]"),
        ElementKind::Point => format!("({name}{mark})"),
        ElementKind::Spring { .. } => format!("~{name}{mark}~"),
        ElementKind::Gear { ratio } => format!("<{name}{mark} {}:1>", number(ratio)),
        ElementKind::Differential { factor } => format!("<{name}{mark} \u{d7}{}>", number(factor)),
        ElementKind::Shaft => format!("={name}{mark}="),
        ElementKind::Winding | ElementKind::Servo => format!("{{{name}{mark}}}"),
        ElementKind::Bearing { .. } => format!("\u{2534} {name}{mark}"),
        ElementKind::GroundSpring { .. } => format!("\u{2534} ~{name}{mark}~"),
        ElementKind::Sensor { role: Role::Input, .. } => format!("\u{25bc} {name}{mark}"),
        ElementKind::Sensor { .. } => format!("\u{25b3} {name}{mark}"),
    }
}
