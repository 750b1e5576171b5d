//! A picture of the window without a display: egui's triangles, filled in software. The same input gives the same bytes on every
//! machine.

use egui::epaint::ClippedShape;
use egui::epaint::{Primitive, Vertex};
use egui::{ClippedPrimitive, Color32, ColorImage, ImageData, Rect, TextureId, TexturesDelta};
use std::collections::HashMap;

/// Textures of the window, as they are known from its output so far.
#[derive(Debug, Default)]
pub struct Raster {
    textures: HashMap<TextureId, ColorImage>,
}

impl Raster {
    /// Takes what an output says of textures; every output has to be told, in order.
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
        let mut image = ColorImage::filled(size, ground);
        for ClippedPrimitive { clip_rect, primitive } in ctx.tessellate(shapes, scale) {
            let Primitive::Mesh(mesh) = primitive else { continue };
            let Some(texture) = self.textures.get(&mesh.texture_id) else { continue };
            let clip = pixels(clip_rect, scale, size);
            for corners in mesh.indices.as_chunks::<3>().0 {
                let corners = corners.map(|index| mesh.vertices[index as usize]);
                triangle(&mut image, texture, corners, scale, clip);
            }
        }
        image
    }
}

/// Columns and rows inside a rectangle: from, to, from, to.
fn pixels(rect: Rect, scale: f32, size: [usize; 2]) -> [i32; 4] {
    let edge = |value: f32, most: usize| (value * scale).round().clamp(0.0, most as f32) as i32;
    [
        edge(rect.min.x, size[0]),
        edge(rect.max.x, size[0]),
        edge(rect.min.y, size[1]),
        edge(rect.max.y, size[1]),
    ]
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
    let (from_x, to_x) = (low([a.x, b.x, c.x]).max(clip[0]), high([a.x, b.x, c.x]).min(clip[1]));
    let (from_y, to_y) = (low([a.y, b.y, c.y]).max(clip[2]), high([a.y, b.y, c.y]).min(clip[3]));
    let plain = corners[0].color == corners[1].color
        && corners[1].color == corners[2].color
        && corners.iter().all(|corner| corner.uv == corners[0].uv);
    let colours = corners.map(|corner| corner.color.to_array().map(f32::from));
    let one = plain.then(|| shade(texture, corners[0].uv.x, corners[0].uv.y, colours[0]));
    let width = image.size[0];
    // Of an edge that two triangles share, each pixel belongs to one of them.
    let edges = [(b, c), (c, a), (a, b)].map(|(p, q)| {
        let (dx, dy) = (q.x - p.x, q.y - p.y);
        let (dx, dy) = if area > 0.0 { (dx, dy) } else { (-dx, -dy) };
        (p, dx, dy, dy < 0.0 || (dy == 0.0 && dx > 0.0))
    });
    let size = area.abs();
    for y in from_y..to_y {
        for x in from_x..to_x {
            let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
            let weights = edges.map(|(p, dx, dy, _)| dx * (py - p.y) - dy * (px - p.x));
            let inside =
                weights.iter().zip(&edges).all(|(weight, edge)| *weight > 0.0 || (*weight == 0.0 && edge.3));
            if !inside {
                continue;
            }
            let source = one.unwrap_or_else(|| {
                let [u, v, w] = weights.map(|weight| weight / size);
                let mix = |values: [f32; 3]| values[0] * u + values[1] * v + values[2] * w;
                let colour = [0, 1, 2, 3].map(|k| mix([colours[0][k], colours[1][k], colours[2][k]]));
                let uv = corners.map(|corner| corner.uv);
                shade(texture, mix(uv.map(|uv| uv.x)), mix(uv.map(|uv| uv.y)), colour)
            });
            blend(&mut image.pixels[y as usize * width + x as usize], source);
        }
    }
}

/// The texture's colour there (premultiplied, between its four neighbours) times the vertex' colour, 0 to 255.
fn shade(texture: &ColorImage, u: f32, v: f32, colour: [f32; 4]) -> [f32; 4] {
    let [width, height] = texture.size;
    let (x, y) = ((u * width as f32 - 0.5).max(0.0), (v * height as f32 - 0.5).max(0.0));
    let (left, top) = ((x as usize).min(width - 1), (y as usize).min(height - 1));
    let (right, bottom) = ((left + 1).min(width - 1), (top + 1).min(height - 1));
    let (fx, fy) = (x - left as f32, y - top as f32);
    let at = |x: usize, y: usize| texture.pixels[y * width + x].to_array();
    let corners = [at(left, top), at(right, top), at(left, bottom), at(right, bottom)];
    let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
    let texel =
        |k: usize| corners.iter().zip(weights).map(|(corner, w)| f32::from(corner[k]) * w).sum::<f32>();
    [0, 1, 2, 3].map(|k| texel(k) * colour[k] / 255.0)
}

/// Lays a premultiplied colour over a pixel.
fn blend(pixel: &mut Color32, source: [f32; 4]) {
    let under = pixel.to_array();
    let rest = 1.0 - source[3] / 255.0;
    let over = [0, 1, 2, 3].map(|k| (source[k] + f32::from(under[k]) * rest + 0.5).clamp(0.0, 255.0) as u8);
    *pixel = Color32::from_rgba_premultiplied(over[0], over[1], over[2], over[3]);
}

/// A picture as PNG.
///
/// # Errors
/// When the picture has no pixels.
pub fn png(image: &ColorImage) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.size[0] as u32, image.size[1] as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let pixels: Vec<u8> = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
    let mut writer = encoder.write_header().map_err(|error| error.to_string())?;
    writer.write_image_data(&pixels).map_err(|error| error.to_string())?;
    writer.finish().map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Draws shapes before they have become a window's output, with the fonts as they are now.
#[must_use]
pub fn of_shapes(ctx: &egui::Context, shapes: Vec<ClippedShape>, part: Rect, ground: Color32) -> ColorImage {
    let scale = ctx.pixels_per_point();
    let fonts = ctx.fonts(|fonts| fonts.image());
    let raster = Raster { textures: [(TextureId::default(), fonts)].into() };
    let size = [part.width(), part.height()].map(|points| (points * scale).round() as usize);
    raster.draw(ctx, shapes, scale, size, ground)
}
