//! The lines between elements.

use super::{
    Item, Paint, Point, Shape,
    grid::{Grid, RowPosition, row_position},
    symbols::half_width,
};
use crate::layout::{Element, Joint, Layout};

/// Distance between the tracks of vertical wires.
const TRACK: f64 = 9.0;

/// All wires of a layout.
pub(super) fn all(layout: &Layout, grid: &Grid) -> Vec<Item> {
    let (tracks, counts) = layout.tracks();
    let each = layout.joints.iter().zip(tracks);
    each.flat_map(|(joint, track)| wire(layout, *joint, grid, (track, &counts))).collect()
}

fn line(points: Vec<Point>) -> Item {
    Item { paint: Paint::Wire, shape: Shape::Line(points) }
}

/// A wire between two elements; `counts` is the number of tracks before each column.
fn wire(layout: &Layout, joint: Joint, grid: &Grid, (track, counts): (usize, &[usize])) -> Vec<Item> {
    let (Some(from), Some(to)) = (layout.elements.get(joint.from), layout.elements.get(joint.to)) else {
        return Vec::new();
    };
    if row_position(to.kind) != RowPosition::Chain || from.column == to.column {
        let (upper, lower) = if to.row < from.row { (to, from) } else { (from, to) };
        let x = grid.middle(from);
        return vec![line(vec![[x, grid.lower(upper)], [x, grid.upper(lower)]])];
    }
    if from.line != to.line {
        return continuation(from, to, grid);
    }
    let (left, right) = if from.column < to.column { (from, to) } else { (to, from) };
    let start = [grid.middle(left) + half_width(left.kind), grid.wire(left)];
    let end = [grid.middle(right) - half_width(right.kind), grid.wire(right)];
    if start[1] == end[1] {
        return vec![line(vec![start, end])];
    }
    // The corner stands between cells, on its track.
    let off = track as f64 - 0.5 * counts[right.column].saturating_sub(1) as f64;
    let corner = grid.middle(left) + 0.5 * grid.cell + TRACK * off;
    vec![line(vec![start, [corner, start[1]], [corner, end[1]], end])]
}

/// The continuation of a wrapped chain: an arrow out of one line and one into the next.
fn continuation(from: &Element, to: &Element, grid: &Grid) -> Vec<Item> {
    let (y_out, y_in) = (grid.wire(from), grid.wire(to));
    let end = grid.middle(from) + 0.5 * grid.cell + 4.0;
    let start = grid.middle(to) - 0.5 * grid.cell - 12.0;
    let arrow = |x: f64, y: f64| Item {
        paint: Paint::Solid,
        shape: Shape::Polygon(vec![[x, y - 4.5], [x + 8.0, y], [x, y + 4.5]]),
    };
    vec![
        line(vec![[grid.middle(from) + half_width(from.kind), y_out], [end, y_out]]),
        line(vec![[start, y_in], [grid.middle(to) - half_width(to.kind), y_in]]),
        arrow(end, y_out),
        arrow(start, y_in),
    ]
}
