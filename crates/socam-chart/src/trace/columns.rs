//! A dense line as a strip: between two columns of pixels it covers the range that the line has in both.

use egui::{Color32, Mesh, Rect, Shape, pos2};

use super::Pen;

/// Lowest and highest position of the line in a column of pixels; empty where low is above high.
type Range = [f32; 2];
const EMPTY: Range = [f32::INFINITY, f32::NEG_INFINITY];
/// Pixels of an edge over which the colour fades.
const SOFT: f32 = 1.0;

/// The line through points that are ordered from left to right.
///
/// The edge of the strip fades upwards and downwards only, so that it stays within the range of the line at corners of any shape. A
/// spike is at least a pixel wide at its tip.
pub(super) fn mesh(points: &[[f64; 2]], clip: Rect, pen: Pen) -> Option<Shape> {
    let (first, ranges) = ranges(points, clip, f64::from(pen.pixels_per_point))?;
    let (half, soft) = (0.5 * pen.width, 0.5 * SOFT / pen.pixels_per_point);
    // Number of columns on either side of a border that a steep line covers by its width.
    let reach = ((0.5 * pen.width * pen.pixels_per_point).round() as usize).max(1);
    let ends = [clip.top() - 4.0, clip.bottom() + 4.0];
    let borders = ranges.len() + 2 * reach - 1;
    let mut mesh = Mesh::default();
    mesh.reserve_vertices(4 * borders);
    mesh.reserve_triangles(6 * borders);
    for border in 1..=borders {
        // The first borders are left of the line's first column.
        let [low, high] = joined(&ranges[border.saturating_sub(2 * reach)..border.min(ranges.len())]);
        let x = (first as f32 + border as f32 - reach as f32) / pen.pixels_per_point;
        let edges = [low - half - soft, low - half + soft, high + half - soft, high + half + soft];
        let corner = mesh.vertices.len() as u32;
        for (y, colour) in
            edges.into_iter().zip([Color32::TRANSPARENT, pen.colour, pen.colour, Color32::TRANSPARENT])
        {
            mesh.colored_vertex(pos2(x, y.clamp(ends[0], ends[1])), colour);
        }
        if border > 1 {
            for row in corner..corner + 3 {
                mesh.add_triangle(row - 4, row - 3, row);
                mesh.add_triangle(row - 3, row, row + 1);
            }
        }
    }
    (!mesh.is_empty()).then(|| Shape::mesh(mesh))
}

/// The range of several columns.
fn joined(ranges: &[Range]) -> Range {
    ranges.iter().fold(EMPTY, |a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// The range of the line in each column of pixels from the first one on.
fn ranges(points: &[[f64; 2]], clip: Rect, scale: f64) -> Option<(i64, Vec<Range>)> {
    let ends = [f64::from(clip.left()) - 8.0, f64::from(clip.right()) + 8.0];
    let column = |x: f64| (x.clamp(ends[0], ends[1]) * scale).floor() as i64;
    let (first, last) = (column(points.first()?[0]), column(points.last()?[0]));
    let mut ranges = vec![EMPTY; (last - first + 1).max(1) as usize];
    let mut extend = |column: i64, y: f64| {
        let range = &mut ranges[(column - first) as usize];
        *range = [range[0].min(y as f32), range[1].max(y as f32)];
    };
    let mut from = first;
    for pair in points.windows(2) {
        let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
        let to = column(x1);
        extend(from, y0);
        for border in from + 1..=to {
            // Fraction of the segment at which it crosses from a column into the next one; a point beyond the picture is in the
            // outermost column.
            let share = ((border as f64 / scale - x0) / (x1 - x0)).clamp(0.0, 1.0);
            let y = y0 + share * (y1 - y0);
            extend(border - 1, y);
            extend(border, y);
        }
        extend(to, y1);
        from = to;
    }
    Some((first, ranges))
}
