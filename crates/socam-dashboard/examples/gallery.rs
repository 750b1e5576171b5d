//! Draws every view in every state, light and dark, at three sizes, to be looked at:
//! `cargo run --release -p socam-dashboard --example gallery -- FOLDER [STATE...]`.

use std::path::PathBuf;
use std::time::Duration;

use socam_chart::raster;
use socam_chart::theme::Look;
use socam_dashboard::{Viewport, picture};

#[path = "../tests/panels/sample/mod.rs"]
mod sample;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("say into which folder")?);
    std::fs::create_dir_all(&folder)?;
    let wanted: Vec<String> = std::env::args().skip(2).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|wanted| wanted == name);
    for name in sample::STATES.into_iter().filter(|name| is_wanted(name)) {
        for (look, of_look) in [(Look::Light, "light"), (Look::Dark, "dark")] {
            // The last one is a screen of 3840 by 2160 pixels.
            for (size, scale) in [([800.0, 600.0], 1.0), ([1280.0, 800.0], 1.0), ([2560.0, 1440.0], 1.5)] {
                let Some(mut dashboard) = sample::state(name, look) else { continue };
                let image = picture(&mut dashboard, Viewport { size, scale }, Duration::from_secs(60))?;
                std::fs::write(
                    folder.join(format!("{name}-{of_look}-{}.png", size[0] as u32)),
                    raster::png(&image)?,
                )?;
            }
        }
    }
    Ok(())
}
