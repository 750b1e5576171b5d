//! Cost of a picture of the running bench: `cargo run --release -p socam-dashboard --example live_frame -- [FRAMES]`.
//!
//! Six channels at 10 kHz come in through the live view's own link; ten seconds of them are in sight at 1280x800. Prints, for each
//! step of a frame, the time of the processor, which other programs on the machine do not lengthen, and the frames per second that a
//! processor alone would draw, without a graphics card.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;
use egui::{RawInput, Rect, pos2, vec2};
use socam_chart::raster::Raster;
use socam_dashboard::{Dashboard, Layout, View, wake};
use socam_recording::{Channel, Unit};
use socam_workbench::device::Peer;
use socam_workbench::link::{Bench, News, link};
use socam_workbench::queue::Batch;

const CHANNELS: usize = 6;
const RATE_HZ: f64 = 10_000.0;
const IN_SIGHT_S: f64 = 10.0;
/// The pace of the pictures decides how many samples each of them brings.
const FRAME_S: f64 = 1.0 / 30.0;
const SIZE: [f32; 2] = [1280.0, 800.0];

/// A slow wave with noise, as sensors give it, and a reading that is missing now and then.
fn batch(first: usize, count: usize, noise: &mut u64) -> Batch {
    let time_s: Vec<f64> = (first..first + count).map(|row| row as f64 / RATE_HZ).collect();
    let mut draw = || {
        *noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*noise >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut values = Vec::with_capacity(count * CHANNELS);
    for time in &time_s {
        for channel in 0..CHANNELS {
            let value = (time * (1.0 + channel as f64)).sin() + 0.2 * draw();
            values.push(if draw() > 0.4999 { f64::NAN } else { value });
        }
    }
    Batch { time_s, step_s: 1.0 / RATE_HZ, after_setup: false, gaps: None, values }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let frames: usize = std::env::args().nth(1).map_or(Ok(150), |text| text.parse())?;
    let ends: Arc<Mutex<Option<Bench>>> = Arc::default();
    let mut dashboard = Dashboard::new(Layout { view: View::Live, ..Layout::default() });
    let theirs = ends.clone();
    dashboard.workspace.bench.connect_by(Box::new(move |_| {
        let (port, bench) = link();
        *theirs.lock().expect("one thread") = Some(bench);
        port
    }));
    let ctx = egui::Context::default();
    dashboard.set_up(&ctx);
    dashboard.workspace.connect(wake(&ctx));
    let bench = ends.lock().expect("one thread").take().ok_or("the link was not made")?;
    let channels = (0..CHANNELS).map(|n| Channel::new(format!("channel_{n}"), Unit::V)).collect();
    let limits = vec![Some(2.0); CHANNELS];
    bench.news.send(News::Connected { peer: Peer::Board, board: "a board".into(), channels, limits })?;

    let mut noise = 1;
    let mut row = 0;
    let mut raster = Raster::default();
    let mut spent = [Duration::ZERO; 3];
    let mut wall = Duration::ZERO;
    let warm = (IN_SIGHT_S / FRAME_S) as usize;
    for frame in 0..warm + frames {
        let count = (RATE_HZ * FRAME_S).round() as usize;
        bench.samples.push(batch(row, count, &mut noise));
        row += count;
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(SIZE[0], SIZE[1]))),
            time: Some(frame as f64 * FRAME_S),
            ..RawInput::default()
        };
        let (begin, start) = (Instant::now(), ThreadTime::now());
        let mut output = ctx.run_ui(input, |ui| dashboard.ui(ui));
        raster.take(&mut output.textures_delta);
        let laid_out = start.elapsed();
        let primitives = ctx.tessellate(output.shapes, output.pixels_per_point);
        let tessellated = start.elapsed();
        let ground = ctx.global_style().visuals.panel_fill;
        let image = raster.fill(&primitives, output.pixels_per_point, SIZE.map(|side| side as usize), ground);
        let filled = start.elapsed();
        assert!(image.pixels.iter().any(|pixel| *pixel != ground));
        if frame >= warm {
            let steps = [laid_out, tessellated - laid_out, filled - tessellated];
            spent.iter_mut().zip(steps).for_each(|(sum, step)| *sum += step);
            wall += begin.elapsed();
        }
    }
    report(spent, wall, frames);
    Ok(())
}

/// Prints the mean times of the steps of a frame.
fn report(spent: [Duration; 3], wall: Duration, frames: usize) {
    let ms = |time: Duration| 1e3 * time.as_secs_f64() / frames as f64;
    let [layout, triangles, fill] = spent.map(ms);
    let whole = layout + triangles + fill;
    println!(
        "live, {CHANNELS} channels at {RATE_HZ} Hz, {IN_SIGHT_S} s of them at {} x {}:",
        SIZE[0], SIZE[1]
    );
    println!(
        "  panels and lines {layout:.2} ms, triangles {triangles:.2} ms, filling them {fill:.2} ms of the processor"
    );
    println!("  together {whole:.2} ms a frame, {:.0} frames/s; on the wall {:.2} ms", 1e3 / whole, ms(wall));
}
