//! The grid of a drawing: a cell for each element, rows as high as their symbols and labels.

use super::{Point, symbols};
use crate::layout::{Element, ElementKind, Layout};

/// Mean width of a letter of a label in common fonts.
pub(super) const LETTER_WIDTH: f64 = 6.8;
/// Height of a line of a label.
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
const MARGIN: f64 = 18.0;

/// Widths and heights of the cells.
pub(super) struct Grid {
    /// Width of a cell.
    pub(super) cell: f64,
    /// Top of each row, and the bottom of the last.
    tops: Vec<f64>,
    /// Height of the labels above the symbols of each row.
    labels: Vec<f64>,
}

/// Position of an element in its row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RowPosition {
    /// Above the chain, as a box with a label.
    Sensor,
    /// The element is on the wire.
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

impl Grid {
    pub(super) fn new(layout: &Layout, cell: f64) -> Self {
        // A diamond may stand above the first row.
        let mut grid = Self { cell, tops: vec![SPACE + BADGE], labels: Vec::new() };
        for row in 0..layout.rows {
            let there = || layout.elements.iter().filter(|element| element.row == row);
            let text = there().map(|element| grid.text_height(element)).fold(0.0, f64::max);
            let symbol = there().map(|element| symbol_height(element.kind)).fold(0.0, f64::max);
            let has = |row, position| {
                layout
                    .elements
                    .iter()
                    .any(|element| element.row == row && row_position(element.kind) == position)
            };
            // In a wrapped chain a diamond above a sensor stands below the labels of bearings.
            let is_before_sensors = has(row, RowPosition::Grounded) && has(row + 1, RowPosition::Sensor);
            let space = if is_before_sensors { SPACE + BADGE } else { SPACE };
            let top = grid.bottom();
            grid.labels.push(text);
            grid.tops.push(top + text + symbol + space);
        }
        grid
    }

    fn bottom(&self) -> f64 {
        self.tops.last().copied().unwrap_or_default()
    }

    /// Width and height of the whole drawing.
    pub(super) fn size(&self, layout: &Layout) -> Point {
        [self.cell * layout.columns as f64 + 2.0 * MARGIN, self.bottom().ceil()]
    }

    /// Horizontal position of an element's middle.
    pub(super) fn middle(&self, element: &Element) -> f64 {
        MARGIN + self.cell * (element.column as f64 + 0.5)
    }

    /// Height of the wire that runs through an element's symbol.
    pub(super) fn wire(&self, element: &Element) -> f64 {
        self.tops[element.row] + self.labels[element.row] + 0.5 * SYMBOL
    }

    /// Lower edge of an element with its label.
    pub(super) fn lower(&self, element: &Element) -> f64 {
        match row_position(element.kind) {
            RowPosition::Sensor => self.tops[element.row + 1] - SPACE,
            RowPosition::Chain => self.wire(element) + symbols::reach(element.kind),
            RowPosition::Grounded => self.tops[element.row] + GROUNDED + self.text_height(element),
        }
    }

    /// Upper edge of an element with its label.
    pub(super) fn upper(&self, element: &Element) -> f64 {
        let text = self.text_height(element);
        match row_position(element.kind) {
            RowPosition::Sensor => self.lower(element) - text - 8.0,
            RowPosition::Chain => self.tops[element.row] + self.labels[element.row] - text,
            RowPosition::Grounded => self.tops[element.row],
        }
    }

    /// Corners of an element with its label.
    pub(super) fn area(&self, element: &Element) -> [Point; 2] {
        let (x, half) = (self.middle(element), 0.5 * self.cell - 0.5);
        [[x - half, self.upper(element)], [x + half, self.lower(element)]]
    }

    fn text_height(&self, element: &Element) -> f64 {
        LINE_HEIGHT * self.lines(element).len() as f64
    }

    /// Lines of an element's label: its name, and the effects that the model has there.
    pub(super) fn lines(&self, element: &Element) -> Vec<String> {
        let fits = ((self.cell - 6.0) / LETTER_WIDTH) as usize;
        let mut lines = wrap(&element.name, fits);
        for effect in &element.effects {
            lines.extend(wrap(&format!("+ {effect}"), fits));
        }
        lines
    }
}

fn symbol_height(kind: ElementKind) -> f64 {
    match row_position(kind) {
        RowPosition::Sensor => 8.0,
        RowPosition::Chain => SYMBOL,
        RowPosition::Grounded => GROUNDED,
    }
}

/// Wraps a name behind underscores, spaces, hyphens and dots, and within a word only where the word is longer than a line.
fn wrap(name: &str, fits: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in name.split_inclusive(['_', ' ', '-', '.']) {
        let mut rest: Vec<char> = word.chars().collect();
        while !rest.is_empty() {
            let used = lines.last().map_or(0, |line| line.chars().count());
            if used > 0 && used + rest.len() > fits {
                lines.push(String::new());
                continue;
            }
            let part = rest.len().min(fits);
            if let Some(line) = lines.last_mut() {
                line.extend(rest.drain(..part));
            }
        }
    }
    lines
}
