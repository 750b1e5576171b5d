//! Pictures as PNG files.

use egui::ColorImage;

/// A picture as PNG.
///
/// # Errors
/// When the picture has no pixels.
pub fn png(image: &ColorImage) -> Result<Vec<u8>, String> {
    let pixels = image.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]);
    encoded(image.size, png::ColorType::Rgb, &pixels.collect::<Vec<u8>>())
}

/// A picture as PNG that is transparent where it has no colour.
pub(crate) fn png_with_holes(image: &ColorImage) -> Result<Vec<u8>, String> {
    let pixels = image.pixels.iter().flat_map(|pixel| pixel.to_srgba_unmultiplied());
    encoded(image.size, png::ColorType::Rgba, &pixels.collect::<Vec<u8>>())
}

fn encoded(size: [usize; 2], colours: png::ColorType, pixels: &[u8]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0] as u32, size[1] as u32);
    encoder.set_color(colours);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().map_err(|error| error.to_string())?;
    writer.write_image_data(pixels).map_err(|error| error.to_string())?;
    writer.finish().map_err(|error| error.to_string())?;
    Ok(bytes)
}
