//! Every view is drawn and compared with its picture in `tests/snapshots`; `UPDATE_SNAPSHOTS=1` draws them anew.
//!
//! Drawn by the dashboard's own rasteriser, so they are the same on a machine without display or graphics card.

use std::path::Path;
use std::time::Duration;

use egui::{Color32, ColorImage};
use socam_chart::raster;
use socam_chart::theme::Look;
use socam_dashboard::{Viewport, picture_by_own_fonts as picture};

use crate::sample;

const SMALL: Viewport = Viewport { size: [1280.0, 800.0], scale: 1.0 };
/// A small window in which everything is a quarter larger.
const NARROW: Viewport = Viewport { size: [800.0, 600.0], scale: 1.25 };
const LARGE: Viewport = Viewport { size: [2560.0, 1440.0], scale: 1.0 };

/// Look and size in which each state is drawn here; example `gallery` draws all states in all looks.
const DRAWN: [(&str, Look, Viewport); 51] = [
    ("time-clock", Look::Dark, SMALL),
    ("spectrum-window", Look::Light, NARROW),
    ("identify-range", Look::Light, SMALL),
    ("machine-columns", Look::Dark, NARROW),
    ("time-bench", Look::Dark, SMALL),
    ("time-formula", Look::Light, NARROW),
    ("response-decibel", Look::Light, SMALL),
    ("time", Look::Dark, SMALL),
    ("time-trouble", Look::Light, SMALL),
    ("time-one-sample", Look::Light, SMALL),
    ("time-differences", Look::Light, LARGE),
    ("time-twelve", Look::Dark, SMALL),
    ("time-tiles", Look::Light, SMALL),
    ("time-thirty", Look::Dark, SMALL),
    ("time-derive", Look::Dark, NARROW),
    ("time-empty", Look::Light, SMALL),
    ("time-wrong", Look::Dark, SMALL),
    ("spectrum", Look::Light, SMALL),
    ("spectrum-twelve", Look::Dark, SMALL),
    ("response", Look::Dark, SMALL),
    ("poles", Look::Light, SMALL),
    ("check", Look::Light, SMALL),
    ("check-twelve", Look::Dark, SMALL),
    ("identify", Look::Light, SMALL),
    ("identify-setup", Look::Dark, NARROW),
    ("diagnosis", Look::Light, SMALL),
    ("diagnosis-signals", Look::Light, SMALL),
    ("diagnosis-torque", Look::Dark, LARGE),
    ("diagnosis-frequency", Look::Dark, SMALL),
    ("diagnosis-time", Look::Dark, SMALL),
    ("diagnosis-fit", Look::Light, SMALL),
    ("diagnosis-shape", Look::Dark, SMALL),
    ("time-nothing", Look::Dark, SMALL),
    ("diagnosis-angle", Look::Light, SMALL),
    ("diagnosis-empty", Look::Light, SMALL),
    ("live-empty", Look::Dark, SMALL),
    ("live", Look::Light, LARGE),
    ("live-fault", Look::Dark, NARROW),
    ("live-text", Look::Light, SMALL),
    ("live-drive", Look::Dark, SMALL),
    ("live-drive-run", Look::Light, SMALL),
    ("watch", Look::Light, SMALL),
    ("fleet", Look::Light, SMALL),
    ("fleet-machine", Look::Dark, SMALL),
    ("fleet-findings", Look::Light, NARROW),
    ("fleet-unfit", Look::Dark, SMALL),
    ("fleet-empty", Look::Light, SMALL),
    ("machine", Look::Light, SMALL),
    ("machine-empty", Look::Dark, SMALL),
    ("machine-new", Look::Dark, NARROW),
    ("machine-sliding", Look::Dark, SMALL),
];

#[test]
fn every_view_looks_as_it_did() {
    let draw = |(name, look, viewport): (&str, Look, Viewport)| {
        assert!(sample::STATES.contains(&name), "{name}");
        let mut dashboard = sample::state(name, look).unwrap();
        let image = picture(&mut dashboard, viewport, Duration::from_secs(60)).unwrap();
        compare(name, &image).err()
    };
    let problems: Vec<String> = DRAWN.into_iter().filter_map(draw).collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Letters may come out a shade different where another processor rounds otherwise.
const SHADES: u8 = 8;
const OTHERS: usize = 40;

/// Compares with the picture of that name, or keeps it as that when it is to be drawn anew.
fn compare(name: &str, image: &ColorImage) -> Result<(), String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    let file = folder.join(format!("{name}.png"));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&file, raster::png(image).unwrap()).unwrap();
        return Ok(());
    }
    let differ = |(a, b): &(&Color32, &Color32)| {
        a.to_array().iter().zip(b.to_array()).any(|(a, b)| a.abs_diff(b) > SHADES)
    };
    let others = match read(&file) {
        Ok(known) if known.size == image.size => {
            known.pixels.iter().zip(&image.pixels).filter(differ).count()
        }
        _ => image.pixels.len(),
    };
    if others <= OTHERS {
        return Ok(());
    }
    let new = folder.join(format!("{name}.new.png"));
    std::fs::write(&new, raster::png(image).unwrap()).unwrap();
    Err(format!(
        "{name}: {others} pixels differ; look at {}, and draw it anew with UPDATE_SNAPSHOTS=1 if it is right",
        new.display()
    ))
}

fn read(file: &Path) -> Result<ColorImage, Box<dyn std::error::Error>> {
    let mut reader = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(file)?)).read_info()?;
    let mut bytes = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let info = reader.next_frame(&mut bytes)?;
    let size = [info.width as usize, info.height as usize];
    assert_eq!(info.color_type, png::ColorType::Rgb, "{}", file.display());
    Ok(ColorImage::from_rgb(size, &bytes[..info.buffer_size()]))
}

#[test]
fn the_same_state_gives_the_same_bytes() {
    let draw = || {
        let mut dashboard = sample::state("time", Look::Dark).unwrap();
        picture(&mut dashboard, SMALL, Duration::from_secs(60)).unwrap().pixels
    };
    assert!(draw() == draw());
}
