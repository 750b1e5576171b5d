//! Draws every view in every state, light and dark, at three sizes, to be looked at:
//! `cargo run --release -p socam-dashboard --example gallery -- FOLDER [STATE|light|dark|800|1280|2560...]`.
//! Words choose among the pictures: those of the named states, themes and widths are drawn.

use std::path::PathBuf;
use std::time::Duration;

use socam_chart::raster;
use socam_chart::theme::Look;
use socam_dashboard::{Viewport, picture};

#[path = "../tests/panels/sample/mod.rs"]
mod sample;

const LOOKS: [&str; 2] = ["light", "dark"];
/// Of the windows, points.
const WIDTHS: [&str; 3] = ["800", "1280", "2560"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let folder = words.next().filter(|word| !word.starts_with('-')).ok_or("say into which folder")?;
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;
    let wanted: Vec<String> = words.collect();
    if let Some(word) = wanted.iter().find(|word| !all_words().any(|known| known == word.as_str())) {
        return Err(format!(
            "{word}: no state, theme or width; say one of {}",
            all_words().collect::<Vec<_>>().join(", ")
        )
        .into());
    }
    for name in chosen(&sample::STATES, &wanted) {
        for of_look in chosen(&LOOKS, &wanted) {
            for width in chosen(&WIDTHS, &wanted) {
                let look = if of_look == "light" { Look::Light } else { Look::Dark };
                let Some(mut dashboard) = sample::state(name, look) else { continue };
                let image = picture(&mut dashboard, viewport(width), Duration::from_secs(60))?;
                std::fs::write(folder.join(format!("{name}-{of_look}-{width}.png")), raster::png(&image)?)?;
            }
        }
    }
    Ok(())
}

fn all_words() -> impl Iterator<Item = &'static str> {
    sample::STATES.into_iter().chain(LOOKS).chain(WIDTHS)
}

/// Those of `all` that are among the words, or all of them if none is.
fn chosen(all: &[&'static str], words: &[String]) -> Vec<&'static str> {
    let named: Vec<&str> = all.iter().copied().filter(|name| words.iter().any(|word| word == name)).collect();
    if named.is_empty() { all.to_vec() } else { named }
}

/// The last one is a screen of 3840 by 2160 pixels.
fn viewport(width: &str) -> Viewport {
    match width {
        "800" => Viewport { size: [800.0, 600.0], scale: 1.0 },
        "1280" => Viewport { size: [1280.0, 800.0], scale: 1.0 },
        _ => Viewport { size: [2560.0, 1440.0], scale: 1.5 },
    }
}
