//! A field of colours over two linear axes, such as a spectrogram.

use egui::{Color32, ColorImage, Context, Mesh, Rect, Shape, pos2};
use egui_plot::{PlotPoint, PlotTransform};

use super::colours::Colours;
use super::texture::Texture;

/// Values in columns, each from below, at equal distances.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// Range of the horizontal axis, from the first column's left edge to the last one's right edge.
    pub x: [f64; 2],
    /// Range of the vertical axis.
    pub y: [f64; 2],
    /// Number of rows.
    pub rows: usize,
    /// Column after column; NaN where a value is missing.
    pub values: Vec<f64>,
}

impl Cells {
    /// The value at a point; `None` outside and where it is missing.
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> Option<f64> {
        let index = |value: f64, [low, high]: [f64; 2], count: usize| {
            let share = (value - low) / (high - low);
            (0.0..1.0).contains(&share).then(|| ((share * count as f64) as usize).min(count - 1))
        };
        let column = index(x, self.x, self.values.len() / self.rows.max(1))?;
        let row = index(y, self.y, self.rows)?;
        self.values.get(column * self.rows + row).copied().filter(|value| !value.is_nan())
    }

    /// Least and greatest value.
    #[must_use]
    pub fn range(&self) -> Option<[f64; 2]> {
        super::numbers::range_of(self.values.iter().copied())
    }
}

/// A field that can be drawn. It is made once, not in each frame.
#[derive(Debug, Clone)]
pub struct Heat {
    cells: Cells,
    colours: Colours,
    texture: Texture,
}

impl Heat {
    /// Colours cells; `None` without any.
    #[must_use]
    pub fn new(ctx: &Context, name: &str, cells: Cells, colours: Colours) -> Option<Self> {
        let columns = cells.values.len().checked_div(cells.rows)?;
        if columns == 0 {
            return None;
        }
        let mut image = ColorImage::filled([columns, cells.rows], Color32::TRANSPARENT);
        for (column, values) in cells.values.chunks_exact(cells.rows).enumerate() {
            for (row, value) in values.iter().rev().enumerate() {
                image.pixels[row * columns + column] = colours.of(*value);
            }
        }
        Some(Self { texture: Texture::new(ctx, name, image), cells, colours })
    }

    /// The values.
    #[must_use]
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// The quantity of the colours.
    #[must_use]
    pub fn colours(&self) -> &Colours {
        &self.colours
    }

    /// The pixels, a cell each, from the top left.
    #[must_use]
    pub fn image(&self) -> &ColorImage {
        self.texture.image()
    }

    pub(super) fn shapes(&self, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let corner = |side: usize| {
            transform.position_from_point(&PlotPoint::new(self.cells.x[side], self.cells.y[side]))
        };
        let mut mesh = Mesh::with_texture(self.texture.id());
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        mesh.add_rect_with_uv(Rect::from_two_pos(corner(0), corner(1)), whole, Color32::WHITE);
        shapes.push(Shape::mesh(mesh));
    }
}
