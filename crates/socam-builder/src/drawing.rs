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
/// let drawing = socam_builder::draw(&model, 80);
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
    /// Width of the gap before each column, and behind the last.
    gap_widths: Vec<usize>,
    /// Directions of the wires at each character of each gap, by row.
    gaps: Vec<Vec<Vec<u8>>>,
}

impl Grid {
    fn new(layout: Layout) -> Self {
        let width = |column: usize| {
            let own = layout.elements.iter().filter(|element| element.column == column);
            own.map(|element| label(element).chars().count()).max().unwrap_or(0)
        };
        let widths = (0..layout.columns).map(width).collect();
        let (tracks, counts) = layout.tracks();
        let gap_widths: Vec<usize> = counts.iter().map(|count| (count + 1).max(2)).collect();
        let row: Vec<Vec<u8>> = gap_widths.iter().map(|width| vec![0; *width]).collect();
        let mut grid = Self { gaps: vec![row; layout.rows], widths, gap_widths, layout: Layout::default() };
        for (joint, track) in layout.joints.iter().zip(tracks) {
            grid.wire((&layout.elements[joint.from], &layout.elements[joint.to]), track);
        }
        Self { layout, ..grid }
    }

    /// Draws the wire of a joint: from the left element to its track, along it, and on to the right element.
    fn wire(&mut self, (a, b): (&Element, &Element), track: usize) {
        if a.line != b.line {
            // The chain continues in another line.
            let (first, second) = if a.line < b.line { (a, b) } else { (b, a) };
            self.gaps[first.row][first.column + 1][0] |= LEFT;
            self.gaps[second.row][second.column][1] |= RIGHT;
            return;
        }
        let (left, right) = if a.column < b.column { (a, b) } else { (b, a) };
        if left.column == right.column {
            return;
        }
        let gap = right.column;
        for at in 0..self.gap_widths[gap] {
            self.gaps[left.row][gap][at] |=
                if at <= track { LEFT } else { 0 } | if at < track { RIGHT } else { 0 };
            self.gaps[right.row][gap][at] |=
                if at >= track { RIGHT } else { 0 } | if at > track { LEFT } else { 0 };
        }
        let (top, bottom) = (left.row.min(right.row), left.row.max(right.row));
        for row in top..=bottom {
            self.gaps[row][gap][track] |=
                if row > top { UP } else { 0 } | if row < bottom { DOWN } else { 0 };
        }
    }

    fn width(&self) -> usize {
        self.widths.iter().chain(&self.gap_widths).sum()
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
        let joins =
            |gap: usize, side: usize, way: u8| self.gaps[row][gap][side] & way != 0 && is_chain(element.kind);
        let into = wire(joins(column, self.gap_widths[column] - 1, RIGHT));
        let out = wire(joins(column + 1, 0, LEFT));
        format!("{}{label}{}", into.repeat(before), out.repeat(after))
    }

    fn gap(&self, row: usize, column: usize) -> String {
        let ways = &self.gaps[row][column];
        // At either end the chain continues from or in another line.
        match column {
            0 if ways[1] & RIGHT != 0 => "\u{2192}\u{2500}".into(),
            last if last == self.layout.columns && ways[0] & LEFT != 0 => "\u{2500}\u{2192}".into(),
            _ => ways.iter().map(|ways| corner(*ways)).collect(),
        }
    }
}

/// The character of wires that leave in these directions.
fn corner(ways: u8) -> char {
    match ways {
        0 => ' ',
        w if w & (UP | DOWN) == 0 => '\u{2500}',
        w if w & (LEFT | RIGHT) == 0 => '\u{2502}',
        w if w == LEFT | DOWN => '\u{2510}',
        w if w == RIGHT | DOWN => '\u{250c}',
        w if w == LEFT | UP => '\u{2518}',
        w if w == RIGHT | UP => '\u{2514}',
        w if w == LEFT | RIGHT | DOWN => '\u{252c}',
        w if w == LEFT | RIGHT | UP => '\u{2534}',
        w if w == RIGHT | UP | DOWN => '\u{251c}',
        w if w == LEFT | UP | DOWN => '\u{2524}',
        _ => '\u{253c}',
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
