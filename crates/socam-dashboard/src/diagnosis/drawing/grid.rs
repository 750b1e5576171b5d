//! The grid of the drawing: heights of its rows, and the place of each element.

use egui::{Pos2, Rect, pos2};
use socam_model::layout::{Element, ElementKind, Layout};

pub(super) const LINE: f32 = 13.0;

const SYMBOL: f32 = 52.0;

const GROUNDED: f32 = 34.0;

/// Heights of the rows.
pub(super) struct Grid {
    cell: f32,
    tops: Vec<f32>,
    labels: Vec<f32>,
}

/// Where an element is drawn.
pub(super) struct Place {
    pub(super) all: Rect,
    /// Centre of the symbol, on the shaft.
    pub(super) middle: Pos2,
    pub(super) text_top: f32,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Row {
    Sensor,
    Chain,
    Grounded,
}

pub(super) fn row(kind: ElementKind) -> Row {
    match kind {
        ElementKind::Sensor { .. } => Row::Sensor,
        ElementKind::Bearing { .. } | ElementKind::GroundSpring { .. } => Row::Grounded,
        _ => Row::Chain,
    }
}

impl Grid {
    pub(super) fn new(layout: &Layout, cell: f32) -> Self {
        let (mut tops, mut labels) = (vec![10.0], Vec::new());
        for index in 0..layout.rows {
            let there = || layout.elements.iter().filter(|element| element.row == index);
            let text = there().map(|element| LINE * lines(element, cell).len() as f32).fold(0.0, f32::max);
            let symbol = there().map(|element| match row(element.kind) {
                Row::Sensor => 6.0,
                Row::Chain => SYMBOL,
                Row::Grounded => GROUNDED,
            });
            let top = tops.last().copied().unwrap_or_default();
            tops.push(top + text + symbol.fold(0.0, f32::max) + 12.0);
            labels.push(text);
        }
        Self { cell, tops, labels }
    }

    pub(super) fn height(&self) -> f32 {
        self.tops.last().copied().unwrap_or_default() + 2.0
    }

    pub(super) fn place(&self, element: &Element, corner: Pos2) -> Place {
        let x = corner.x + self.cell * (element.column as f32 + 0.5);
        let top = corner.y + self.tops[element.row];
        let own = LINE * lines(element, self.cell).len() as f32;
        let half = 0.5 * self.cell - 3.0;
        let labels = self.labels[element.row];
        let rect = |from: f32, to: f32| Rect::from_min_max(pos2(x - half, from), pos2(x + half, to));
        match row(element.kind) {
            Row::Sensor => {
                let bottom = corner.y + self.tops[element.row + 1] - 12.0;
                let all = rect(bottom - own - 6.0, bottom);
                Place { all, middle: all.center(), text_top: all.top() + 3.0 }
            }
            Row::Chain => {
                let symbols = top + labels;
                let text_top = symbols - own;
                Place {
                    all: rect(text_top - 2.0, symbols + SYMBOL),
                    middle: pos2(x, symbols + 0.5 * SYMBOL),
                    text_top,
                }
            }
            Row::Grounded => {
                let all = rect(top, top + GROUNDED + own + 2.0);
                Place { all, middle: pos2(x, top), text_top: top + GROUNDED }
            }
        }
    }
}

/// The name of the element and its effects, in lines that fit a cell.
pub(super) fn lines(element: &Element, cell: f32) -> Vec<String> {
    let fits = ((cell - 8.0) / 6.3) as usize;
    let mut lines = wrap(&element.name, fits);
    for effect in &element.effects {
        lines.extend(wrap(&format!("+ {effect}"), fits));
    }
    lines
}

/// Breaks a name after separators; within a word only if the word alone is too long.
fn wrap(name: &str, fits: usize) -> Vec<String> {
    let fits = fits.max(4);
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
