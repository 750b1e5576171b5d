//! A picture of the window without a display: egui's triangles, filled in software. The same input gives the same bytes on every
//! machine.

mod animation;
mod file;

use egui::epaint::ClippedShape;
use egui::epaint::{Primitive, Vertex};
use egui::{ClippedPrimitive, Color32, ColorImage, ImageData, Pos2, Rect, TextureId, TexturesDelta, Vec2};
use std::collections::HashMap;

pub use animation::animation;
pub use file::png;
pub(super) use file::png_with_holes;

/// Textures of the window, collected from its output.
#[derive(Debug, Default)]
pub struct Raster {
    textures: HashMap<TextureId, ColorImage>,
}

impl Raster {
    /// Applies the texture changes of an output; every output must be given, in order.
    pub fn take(&mut self, delta: &mut TexturesDelta) {
        for (id, changes) in std::mem::take(&mut delta.set) {
            for change in changes {
                let ImageData::Color(image) = &change.image;
                match change.pos {
                    None => {
                        self.textures.insert(id, ColorImage::clone(image));
                    }
                    Some(at) => {
                        let Some(whole) = self.textures.get_mut(&id) else { continue };
                        for (row, pixels) in image.pixels.chunks_exact(image.size[0].max(1)).enumerate() {
                            let start = (at[1] + row) * whole.size[0] + at[0];
                            whole.pixels[start..start + pixels.len()].copy_from_slice(pixels);
                        }
                    }
                }
            }
        }
        for id in std::mem::take(&mut delta.free) {
            self.textures.remove(&id);
        }
    }

    /// Draws a window of `size` pixels on a ground.
    #[must_use]
    pub fn draw(
        &self,
        ctx: &egui::Context,
        shapes: Vec<ClippedShape>,
        scale: f32,
        size: [usize; 2],
        ground: Color32,
    ) -> ColorImage {
        self.fill(&ctx.tessellate(shapes, scale), scale, size, ground)
    }

    /// Fills triangles on a ground of `size` pixels.
    #[must_use]
    pub fn fill(
        &self,
        triangles: &[ClippedPrimitive],
        scale: f32,
        size: [usize; 2],
        ground: Color32,
    ) -> ColorImage {
        let mut image = ColorImage::filled(size, ground);
        for ClippedPrimitive { clip_rect, primitive } in triangles {
            let Primitive::Mesh(mesh) = primitive else { continue };
            let Some(texture) = self.textures.get(&mesh.texture_id) else { continue };
            let clip = pixels(*clip_rect, scale, size);
            for corners in mesh.indices.as_chunks::<3>().0 {
                let corners = corners.map(|index| mesh.vertices[index as usize]);
                triangle(&mut image, texture, corners, scale, clip);
            }
        }
        image
    }
}

/// First and end column, first and end row inside a rectangle.
fn pixels(rect: Rect, scale: f32, size: [usize; 2]) -> [i32; 4] {
    let edge = |value: f32, most: usize| (value * scale).round().clamp(0.0, most as f32) as i32;
    [
        edge(rect.min.x, size[0]),
        edge(rect.max.x, size[0]),
        edge(rect.min.y, size[1]),
        edge(rect.max.y, size[1]),
    ]
}

/// An edge of a triangle; its value says on which side a pixel is.
#[derive(Clone, Copy)]
struct Edge {
    from: Pos2,
    along: Vec2,
    /// Columns per row.
    slope: f32,
    /// Whether pixels exactly on the edge belong to this triangle. Of two triangles that share an edge, one owns it.
    owns: bool,
}

impl Edge {
    fn new(from: Pos2, to: Pos2, clockwise: bool) -> Self {
        let along = if clockwise { to - from } else { from - to };
        let owns = along.y < 0.0 || (along.y == 0.0 && along.x > 0.0);
        Self { from, along, slope: along.x / along.y, owns }
    }

    /// Twice the area of the triangle between the edge and the middle of a pixel; positive inside.
    fn area(&self, x: f32, y: f32) -> f32 {
        self.along.x * (y - self.from.y) - self.along.y * (x - self.from.x)
    }

    fn holds(&self, x: f32, y: f32) -> bool {
        let area = self.area(x, y);
        area > 0.0 || (area == 0.0 && self.owns)
    }
}

/// Columns of a row at height `y` whose pixel centres lie inside all edges. The crossings of the edges are computed from their
/// slopes, and the pixels beside them are then tested one by one, so that each pixel belongs to exactly one of two neighbouring
/// triangles.
fn span(edges: &[Edge; 3], y: f32, [mut first, mut last]: [i32; 2]) -> [i32; 2] {
    for edge in edges {
        // Cut off, not rounded down, which takes a call: at the left border that is one pixel less to look at, and none is lost.
        let crossing = (edge.from.x + edge.slope * (y - edge.from.y) - 0.5) as i32;
        if edge.along.y > 0.0 {
            last = last.min(crossing.saturating_add(2));
        } else if edge.along.y < 0.0 {
            first = first.max(crossing.saturating_sub(1));
        }
    }
    let inside = |x: i32| edges.iter().all(|edge| edge.holds(x as f32 + 0.5, y));
    while first < last && !inside(first) {
        first += 1;
    }
    while first < last && !inside(last - 1) {
        last -= 1;
    }
    [first, last]
}

/// Fills a triangle: colours and texture vary over it linearly.
fn triangle(image: &mut ColorImage, texture: &ColorImage, corners: [Vertex; 3], scale: f32, clip: [i32; 4]) {
    let [a, b, c] = corners.map(|corner| corner.pos * scale);
    let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let low = |values: [f32; 3]| values.into_iter().fold(f32::INFINITY, f32::min).floor() as i32;
    let high = |values: [f32; 3]| values.into_iter().fold(f32::NEG_INFINITY, f32::max).ceil() as i32;
    let columns = [low([a.x, b.x, c.x]).max(clip[0]), high([a.x, b.x, c.x]).min(clip[1])];
    let rows = [low([a.y, b.y, c.y]).max(clip[2]), high([a.y, b.y, c.y]).min(clip[3])];
    let edges = [(b, c), (c, a), (a, b)].map(|(p, q)| Edge::new(p, q, area > 0.0));
    let paint = Paint::new(texture, corners, area.abs());
    let width = image.size[0];
    for row in rows[0]..rows[1] {
        let y = row as f32 + 0.5;
        let [first, last] = span(&edges, y, columns);
        if first >= last {
            continue;
        }
        let start = row as usize * width;
        let pixels = &mut image.pixels[start + first as usize..start + last as usize];
        match &paint {
            Paint::Opaque(colour) => pixels.fill(*colour),
            Paint::Even(colour) => pixels.iter_mut().for_each(|pixel| blend(pixel, *colour)),
            Paint::Shaded(shade) => {
                // Colours and texture coordinates change by equal steps along a row.
                let at = |column: i32| {
                    let x = column as f32 + 0.5;
                    shade.at(edges.map(|edge| edge.area(x, y)))
                };
                let (mut colour, next) = (at(first), at(first + 1));
                let step: [f32; 4] = std::array::from_fn(|k| next[k] - colour[k]);
                for pixel in pixels {
                    blend(pixel, colour);
                    colour.iter_mut().zip(step).for_each(|(part, step)| *part += step);
                }
            }
            Paint::Textured(shade, uv) => {
                for (pixel, column) in pixels.iter_mut().zip(first..) {
                    let x = column as f32 + 0.5;
                    let areas = edges.map(|edge| edge.area(x, y));
                    let [u, v] = mix(areas.map(|area| area / shade.whole), uv);
                    let (texel, colour) = (texel(texture, u, v), shade.at(areas));
                    blend(pixel, [0, 1, 2, 3].map(|k| texel[k] * colour[k] / 255.0));
                }
            }
        }
    }
}

/// The filling of a triangle.
enum Paint {
    Opaque(Color32),
    Even([f32; 4]),
    Shaded(Shade),
    Textured(Shade, [[f32; 2]; 3]),
}

/// Colours of the corners, premultiplied, 0 to 255.
struct Shade {
    colours: [[f32; 4]; 3],
    /// Twice the area of the triangle.
    whole: f32,
}

impl Paint {
    fn new(texture: &ColorImage, corners: [Vertex; 3], whole: f32) -> Self {
        let colours = corners.map(|corner| corner.color.to_array().map(f32::from));
        let uv = corners.map(|corner| [corner.uv.x, corner.uv.y]);
        if uv[0] != uv[1] || uv[1] != uv[2] {
            return Self::Textured(Shade { colours, whole }, uv);
        }
        let texel = texel(texture, uv[0][0], uv[0][1]);
        let colours = colours.map(|colour| [0, 1, 2, 3].map(|k| texel[k] * colour[k] / 255.0));
        if colours[0] != colours[1] || colours[1] != colours[2] {
            return Self::Shaded(Shade { colours, whole });
        }
        let [r, g, b, a] = colours[0].map(|part| (part + 0.5).clamp(0.0, 255.0) as u8);
        if a == 255 { Self::Opaque(Color32::from_rgb(r, g, b)) } else { Self::Even(colours[0]) }
    }
}

impl Shade {
    fn at(&self, areas: [f32; 3]) -> [f32; 4] {
        mix(areas.map(|area| area / self.whole), &self.colours)
    }
}

/// The mean of three by their weights.
fn mix<const N: usize>(weights: [f32; 3], of: &[[f32; N]; 3]) -> [f32; N] {
    std::array::from_fn(|k| weights[0] * of[0][k] + weights[1] * of[1][k] + weights[2] * of[2][k])
}

/// The texture's colour there, premultiplied, between its four neighbours; 0 to 255.
fn texel(texture: &ColorImage, u: f32, v: f32) -> [f32; 4] {
    let [width, height] = texture.size;
    let (x, y) = ((u * width as f32 - 0.5).max(0.0), (v * height as f32 - 0.5).max(0.0));
    let (left, top) = ((x as usize).min(width - 1), (y as usize).min(height - 1));
    let (right, bottom) = ((left + 1).min(width - 1), (top + 1).min(height - 1));
    let (fx, fy) = (x - left as f32, y - top as f32);
    let at = |x: usize, y: usize| texture.pixels[y * width + x].to_array();
    let corners = [at(left, top), at(right, top), at(left, bottom), at(right, bottom)];
    let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
    std::array::from_fn(|k| corners.iter().zip(weights).map(|(corner, w)| f32::from(corner[k]) * w).sum())
}

/// Lays a premultiplied colour over a pixel.
fn blend(pixel: &mut Color32, source: [f32; 4]) {
    let under = pixel.to_array();
    let rest = 1.0 - source[3] / 255.0;
    // The conversion to a byte saturates.
    let over: [u8; 4] = std::array::from_fn(|k| (source[k] + f32::from(under[k]) * rest + 0.5) as u8);
    *pixel = Color32::from_rgba_premultiplied(over[0], over[1], over[2], over[3]);
}

/// Draws a part of the window before its shapes have become the window's output, with the current fonts.
#[must_use]
pub fn of_shapes(
    ctx: &egui::Context,
    mut shapes: Vec<ClippedShape>,
    part: Rect,
    ground: Color32,
) -> ColorImage {
    let scale = ctx.pixels_per_point();
    let fonts = ctx.fonts(|fonts| fonts.image());
    let mut raster = Raster { textures: [(TextureId::default(), fonts)].into() };
    let pictures = super::texture::known(ctx).into_iter();
    raster.textures.extend(pictures.map(|(id, image)| (id, ColorImage::clone(&image))));
    if part.min != Pos2::ZERO {
        for clipped in &mut shapes {
            clipped.clip_rect = clipped.clip_rect.translate(-part.min.to_vec2());
            clipped.shape.translate(-part.min.to_vec2());
        }
    }
    let size = [part.width(), part.height()].map(|points| (points * scale).round() as usize);
    raster.draw(ctx, shapes, scale, size, ground)
}

#[cfg(test)]
mod tests;
