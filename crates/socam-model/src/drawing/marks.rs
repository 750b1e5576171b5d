//! Frames around marked places, and the numbered diamonds of findings.

use super::{
    Item, Paint, Point, Shape,
    grid::{BADGE, Grid, RowPosition, row_position},
};
use crate::layout::Element;

/// The mark of a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaceMark {
    /// The finding of this number, from 1.
    Finding(usize),
    /// A place at which a competing explanation acts.
    Rival,
}

/// Numbers of the findings at an element, each once.
fn findings(element: &Element, marks: &[(&str, PlaceMark)]) -> Vec<usize> {
    let mut numbers = Vec::new();
    for (name, mark) in marks {
        if let PlaceMark::Finding(number) = mark
            && *name == element.name
            && !numbers.contains(number)
        {
            numbers.push(*number);
        }
    }
    numbers
}

/// The frame around a marked element.
pub(super) fn frame(element: &Element, grid: &Grid, marks: &[(&str, PlaceMark)]) -> Option<Item> {
    let paint = match () {
        () if !findings(element, marks).is_empty() => Paint::Finding,
        () if marks.contains(&(&element.name, PlaceMark::Rival)) => Paint::Rival,
        () => return None,
    };
    let [from, to] = grid.area(element);
    let shape = Shape::Rect { from: [from[0], from[1] - 4.0], to: [to[0], to[1] + 4.0], corner: 7.0 };
    Some(Item { paint, shape })
}

/// The diamonds of the findings at an element, side by side on an edge of the frame that has no label, and away from the diamonds of the
/// elements around it: at the lower right of the chain, at the upper left below it, and in the middle above it.
pub(super) fn diamonds(items: &mut Vec<Item>, element: &Element, grid: &Grid, marks: &[(&str, PlaceMark)]) {
    let (middle, along) = (grid.middle(element), 0.5 * grid.cell - 4.0);
    for (place, number) in findings(element, marks).into_iter().enumerate() {
        let beside = (2.0 * BADGE + 1.0) * place as f64;
        let at = match row_position(element.kind) {
            RowPosition::Sensor => [middle - beside, grid.upper(element) - 6.0],
            RowPosition::Chain => [middle + along - beside, grid.lower(element) + 4.0],
            RowPosition::Grounded => [middle - along + beside, grid.upper(element)],
        };
        items.extend(diamond(at, number));
    }
}

/// The diamond of a finding around a point, as it stands in a drawing, to name the finding elsewhere.
///
/// ```
/// use socam_model::drawing::{Paint, diamond};
///
/// assert_eq!(diamond([0.0, 0.0], 2).map(|item| item.paint), [Paint::Diamond, Paint::Number]);
/// ```
#[must_use]
pub fn diamond([x, y]: Point, number: usize) -> [Item; 2] {
    let corners = vec![[x, y - BADGE], [x + BADGE, y], [x, y + BADGE], [x - BADGE, y]];
    [
        Item { paint: Paint::Diamond, shape: Shape::Polygon(corners) },
        Item { paint: Paint::Number, shape: Shape::Text { at: [x, y + 4.0], text: number.to_string() } },
    ]
}
