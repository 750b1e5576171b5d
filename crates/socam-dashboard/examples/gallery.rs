//! Draws every view in every state, light and dark, at two sizes, to be looked at:
//! `cargo run --release -p socam-dashboard --example gallery -- FOLDER`.

use std::path::PathBuf;
use std::time::Duration;

use socam_dashboard::draw::raster;
use socam_dashboard::theme::Look;
use socam_dashboard::{Viewport, picture};

#[path = "../tests/panels/sample/mod.rs"]
mod sample;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("say into which folder")?);
    std::fs::create_dir_all(&folder)?;
    for name in sample::STATES {
        for (look, of_look) in [(Look::Light, "light"), (Look::Dark, "dark")] {
            for size in [[1280.0, 800.0], [2560.0, 1440.0]] {
                let Some(mut dashboard) = sample::state(name, look) else { continue };
                let image = picture(&mut dashboard, Viewport { size, scale: 1.0 }, Duration::from_secs(60))?;
                std::fs::write(
                    folder.join(format!("{name}-{of_look}-{}.png", size[0] as u32)),
                    raster::png(&image)?,
                )?;
            }
        }
    }
    Ok(())
}
