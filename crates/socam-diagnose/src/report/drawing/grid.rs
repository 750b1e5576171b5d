//! The drawing's grid: a cell for each element, rows as high as their symbols and labels.

use socam_model::layout::{Element, ElementKind, Layout};

use super::symbols;

/// Width of a cell in the units of the view box.
pub(super) const CELL: f64 = 88.0;
/// Largest number of characters of a label's line: so many fit in a cell.
const LINE_CHARACTERS: usize = 12;
/// Height of a label's line.
pub(super) const LINE_HEIGHT: f64 = 13.0;
/// Height of a symbol of the chain.
const SYMBOL: f64 = 60.0;
/// Height of a symbol that hangs below the chain.
pub(super) const GROUNDED: f64 = 46.0;
/// Space between rows.
const SPACE: f64 = 12.0;
/// Half the height of a finding's diamond.
pub(super) const BADGE: f64 = 10.0;
/// Margin on either side for the arrows of a wrapped chain.
pub(super) const MARGIN: f64 = 18.0;

/// Heights of the grid's rows.
pub(super) struct Rows {
    /// Top of each row, and the bottom of the last.
    tops: Vec<f64>,
    /// Height of the labels above the symbols of each row.
    labels: Vec<f64>,
}

impl Rows {
    pub(super) fn new(layout: &Layout) -> Self {
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

    pub(super) fn bottom(&self) -> f64 {
        self.tops.last().copied().unwrap_or_default()
    }

    fn top(&self, element: &Element) -> f64 {
        self.tops[element.row]
    }

    /// Height of the wire that runs through an element's symbol.
    pub(super) fn wire(&self, element: &Element) -> f64 {
        self.top(element) + self.labels[element.row] + 0.5 * SYMBOL
    }

    /// Lower edge of an element with its label.
    pub(super) fn lower(&self, element: &Element) -> f64 {
        match row_position(element.kind) {
            RowPosition::Sensor => self.tops[element.row + 1] - SPACE,
            RowPosition::Chain => self.wire(element) + symbols::reach(element.kind),
            RowPosition::Grounded => self.top(element) + GROUNDED + LINE_HEIGHT * lines(element).len() as f64,
        }
    }

    /// Upper edge of an element with its label.
    pub(super) fn upper(&self, element: &Element) -> f64 {
        let text = LINE_HEIGHT * lines(element).len() as f64;
        match row_position(element.kind) {
            RowPosition::Sensor => self.lower(element) - text - 8.0,
            RowPosition::Chain => self.top(element) + self.labels[element.row] - text,
            RowPosition::Grounded => self.top(element),
        }
    }
}

/// Where an element is in its row.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum RowPosition {
    /// Below the chain, as a box with a label.
    Sensor,
    /// On the wire.
    Chain,
    /// Hanging from the wire, on the ground.
    Grounded,
}

pub(super) fn row_position(kind: ElementKind) -> RowPosition {
    match kind {
        ElementKind::Sensor { .. } => RowPosition::Sensor,
        ElementKind::Bearing { .. } | ElementKind::GroundSpring { .. } => RowPosition::Grounded,
        _ => RowPosition::Chain,
    }
}

fn symbol_height(element: &Element) -> f64 {
    match row_position(element.kind) {
        RowPosition::Sensor => 8.0,
        RowPosition::Chain => SYMBOL,
        RowPosition::Grounded => GROUNDED,
    }
}

/// Horizontal position of an element's middle.
pub(super) fn middle(element: &Element) -> f64 {
    MARGIN + CELL * (element.column as f64 + 0.5)
}

/// Lines of an element's label: its name, and the effects that the model has there.
pub(super) fn lines(element: &Element) -> Vec<String> {
    let mut lines = wrap(&element.name);
    for effect in &element.effects {
        lines.extend(wrap(&format!("+ {effect}")));
    }
    lines
}

/// Wraps a name behind underscores, spaces, hyphens and dots, and within a word only where the word is longer than a line.
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
