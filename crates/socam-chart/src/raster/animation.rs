//! Pictures that follow one another, as an animated PNG.

use egui::ColorImage;

/// Pictures of one size as an animated PNG that repeats itself, at so many pictures a second. Of each picture only the part is kept that differs
/// from the one before.
///
/// # Errors
/// When there are no pictures, their sizes differ, or they cannot be encoded; one sentence.
pub fn animation(pictures: &[ColorImage], rate_hz: u16) -> Result<Vec<u8>, String> {
    let Some(first) = pictures.first() else { return Err("an animation needs pictures".into()) };
    if pictures.iter().any(|picture| picture.size != first.size) {
        return Err(
            "the pictures of an animation have one size; leave the window as it is while they are drawn"
                .into(),
        );
    }
    let mut bytes = Vec::new();
    write_animation(pictures, first, rate_hz, &mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes)
}

fn write_animation(
    pictures: &[ColorImage],
    first: &ColorImage,
    rate_hz: u16,
    bytes: &mut Vec<u8>,
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(bytes, first.size[0] as u32, first.size[1] as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_animated(pictures.len() as u32, 0)?;
    encoder.set_frame_delay(1, rate_hz.max(1))?;
    let mut writer = encoder.write_header()?;
    let mut before: Option<&ColorImage> = None;
    for picture in pictures {
        let [from, size] = before.map_or([[0, 0], picture.size], |before| changed(before, picture));
        if before.is_some() {
            // A frame is first made small, then put into its place: it must lie in the picture at any time.
            writer.reset_frame_position()?;
            writer.set_frame_dimension(size[0] as u32, size[1] as u32)?;
            writer.set_frame_position(from[0] as u32, from[1] as u32)?;
        }
        let rows = picture.pixels.chunks_exact(picture.size[0].max(1)).skip(from[1]).take(size[1]);
        let pixels = rows.flat_map(|row| &row[from[0]..from[0] + size[0]]);
        let pixels: Vec<u8> = pixels.flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
        writer.write_image_data(&pixels)?;
        before = Some(picture);
    }
    writer.finish()
}

/// Corner and size of the part in which two pictures of one size differ; one pixel where they do not.
fn changed(before: &ColorImage, now: &ColorImage) -> [[usize; 2]; 2] {
    let width = now.size[0].max(1);
    let pixels = before.pixels.iter().zip(&now.pixels).enumerate();
    let others = pixels.filter(|(_, (a, b))| a != b).map(|(index, _)| [index % width, index / width]);
    let (mut from, mut to) = ([usize::MAX; 2], [0; 2]);
    for at in others {
        for axis in 0..2 {
            from[axis] = from[axis].min(at[axis]);
            to[axis] = to[axis].max(at[axis]);
        }
    }
    if from[0] > to[0] { [[0, 0], [1, 1]] } else { [from, [to[0] - from[0] + 1, to[1] - from[1] + 1]] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Color32;

    #[test]
    fn an_animation_holds_its_pictures() {
        let picture = |at: usize| {
            let mut image = ColorImage::filled([20, 10], Color32::from_rgb(9, 9, 9));
            image.pixels[at] = Color32::from_rgb(200, 0, 0);
            image
        };
        // The second differs from the first in two places, the third not at all.
        let bytes = animation(&[picture(21), picture(48), picture(48)], 15).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        let control = reader.info().animation_control.unwrap();
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        let sizes: Vec<(u32, u32)> = (0..3)
            .map(|_| {
                let frame = reader.next_frame(&mut buffer).unwrap();
                (frame.width, frame.height)
            })
            .collect();
        assert_eq!(sizes, [(20, 10), (8, 2), (1, 1)]);
        assert!(animation(&[], 15).is_err() && animation(&[picture(0), ColorImage::default()], 15).is_err());
    }
}
