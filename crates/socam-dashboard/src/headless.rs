//! The dashboard without a display.

use std::time::{Duration, Instant};

use egui::{ColorImage, RawInput, Rect, pos2, vec2};

use crate::Dashboard;
use socam_chart::raster::Raster;

/// Size and scale of a picture.
#[derive(Debug, Clone, Copy)]
pub struct Viewport {
    /// Size in points.
    pub size: [f32; 2],
    /// Pixels per point.
    pub scale: f32,
}

/// Number of passes until the layout does not change any more.
const PASSES: usize = 5;

/// Draws the dashboard once all files are open; the same state gives the same bytes on the same computer. Letters that the window's own
/// fonts lack are drawn by fonts of the system.
///
/// # Errors
/// When files are still being opened after `patience`; one sentence.
pub fn picture(
    dashboard: &mut Dashboard,
    viewport: Viewport,
    patience: Duration,
) -> Result<ColorImage, String> {
    let ctx = egui::Context::default();
    dashboard.letters.by_the_system(&ctx);
    draw(&ctx, dashboard, viewport, patience)
}

/// As [`picture`], with the window's own fonts only: the same state gives the same bytes on every computer.
///
/// # Errors
/// As [`picture`].
pub fn picture_by_own_fonts(
    dashboard: &mut Dashboard,
    viewport: Viewport,
    patience: Duration,
) -> Result<ColorImage, String> {
    draw(&egui::Context::default(), dashboard, viewport, patience)
}

fn draw(
    ctx: &egui::Context,
    dashboard: &mut Dashboard,
    viewport: Viewport,
    patience: Duration,
) -> Result<ColorImage, String> {
    dashboard.set_up(ctx);
    let mut raster = Raster::default();
    let begin = Instant::now();
    let mut passes = 0;
    loop {
        let waits = dashboard.is_busy();
        if waits && begin.elapsed() > patience {
            return Err(format!("files were still being opened after {} s", patience.as_secs()));
        }
        if waits {
            std::thread::sleep(Duration::from_millis(5));
        }
        let mut output = ctx.run_ui(input(viewport, passes), |ui| dashboard.ui(ui));
        raster.take(&mut output.textures_delta);
        passes = if waits || dashboard.is_busy() { 0 } else { passes + 1 };
        if passes >= PASSES {
            let size = viewport.size.map(|points| (points * viewport.scale).round() as usize);
            let ground = ctx.global_style().visuals.panel_fill;
            return Ok(raster.draw(ctx, output.shapes, output.pixels_per_point, size, ground));
        }
    }
}

fn input(viewport: Viewport, pass: usize) -> RawInput {
    let size = vec2(viewport.size[0], viewport.size[1]);
    let mut input = RawInput {
        screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), size)),
        // The clock hardly moves, so that nothing blinks or is animated.
        time: Some(pass as f64 * 0.016),
        focused: true,
        ..RawInput::default()
    };
    if let Some(info) = input.viewports.get_mut(&input.viewport_id) {
        info.native_pixels_per_point = Some(viewport.scale);
    }
    input
}
