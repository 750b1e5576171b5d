//! Cost of a long recording: `cargo run --release -p socam-dashboard --example long_recording -- [MILLION_SAMPLES] [FOLDER]`.
//!
//! Indexes five decoded columns, opens the index again, and pans and zooms through them at 1280x800; prints rates, times and memory.
//! Beside times on the wall it prints those of the processor, which other programs on the machine do not lengthen.
//! Decoding a log comes before all this and is another matter: `socam-recording`'s example `recording_load` measures it.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;

use egui::{RawInput, Rect, pos2, vec2};
use socam_chart::raster::Raster;
use socam_dashboard::Dashboard;
use socam_recording::{Channel, Segment, Unit};
use socam_samples::index::{Writer, open};
use socam_workbench::recording::{About, Recording};

const CHANNELS: usize = 5;
const STEP_S: f64 = 1e-4;
const BLOCK: usize = 4096;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let rows = arguments.next().map_or(Ok(100), |text| text.parse::<usize>())? * 1_000_000;
    let folder = arguments.next().map_or_else(std::env::temp_dir, PathBuf::from);
    let path = folder.join("long_recording.index");
    let spike = rows / 3 * 2 + 12_345;
    let about = build(&path, rows, spike)?;
    println!("index on disk: {:.2} GB", std::fs::metadata(&path)?.len() as f64 / 1e9);

    let begin = Instant::now();
    let (again, samples): (About, _) = open(&path)?;
    println!("opened from its index in {:.3} s", begin.elapsed().as_secs_f64());
    assert_eq!(again, about);
    println!("samples and pyramids take {:.0} MB", samples.bytes() as f64 / 1e6);
    let mut dashboard = Dashboard::default();
    dashboard.add_recording(Recording::in_memory(about, samples));
    pan(&mut dashboard, rows as f64 * STEP_S, spike as f64 * STEP_S);
    println!("memory at most: {:.2} GB", high_water_kb().unwrap_or(f64::NAN) / 1e6);
    std::fs::remove_file(path)?;
    Ok(())
}

fn build(path: &std::path::Path, rows: usize, spike: usize) -> Result<About, Box<dyn std::error::Error>> {
    let wave: Vec<f64> =
        (0..1 << 20).map(|n| (f64::from(n) * 1e-3).sin() + 0.1 * (f64::from(n) * 0.37).sin()).collect();
    let channels = (0..CHANNELS).map(|n| Channel::new(format!("channel_{n}"), Unit::V)).collect();
    let about = About { name: "long".into(), channels, sample_time_s: STEP_S, ..About::default() };
    let mut writer = Writer::create(path, vec![0.0; CHANNELS])?;
    let (mut spent, mut own) = (Duration::ZERO, Duration::ZERO);
    let mut time_s = vec![0.0; BLOCK];
    for first in (0..rows).step_by(BLOCK) {
        let count = BLOCK.min(rows - first);
        time_s.iter_mut().enumerate().for_each(|(n, time)| *time = (first + n) as f64 * STEP_S);
        let start = first % (wave.len() - BLOCK);
        let mut last = wave[start..start + count].to_vec();
        if (first..first + count).contains(&spike) {
            last[spike - first] = 40.0;
        }
        let whole = &wave[start..start + count];
        let (begin, begin_own) = (Instant::now(), ThreadTime::now());
        writer.push(&time_s[..count], &[whole, whole, whole, whole, &last])?;
        (spent, own) = (spent + begin.elapsed(), own + begin_own.elapsed());
    }
    let end_s = (rows - 1) as f64 * STEP_S;
    let segment = Segment {
        first_row: 0,
        rows: rows as u64,
        start_s: 0.0,
        end_s,
        sample_time_s: STEP_S,
        jitter_s: 0.0,
    };
    let (begin, begin_own) = (Instant::now(), ThreadTime::now());
    writer.finish(&about, &[segment])?;
    (spent, own) = (spent + begin.elapsed(), own + begin_own.elapsed());
    let rate = |time: Duration| (rows * CHANNELS) as f64 / time.as_secs_f64() / 1e6;
    println!(
        "indexed {rows} samples x {CHANNELS} channels in {:.2} s, {:.2} s of the processor: {:.0} million values/s, {:.0} of the processor",
        spent.as_secs_f64(),
        own.as_secs_f64(),
        rate(spent),
        rate(own)
    );
    Ok(about)
}

/// Pans at each of many zooms; a frame is layout and tessellation.
fn pan(dashboard: &mut Dashboard, length_s: f64, spike_s: f64) {
    let ctx = egui::Context::default();
    dashboard.set_up(&ctx);
    let mut raster = Raster::default();
    let mut worst: f64 = 0.0;
    let mut width_s = length_s;
    while width_s > 0.01 {
        let mut times_ms = Vec::new();
        for frame in 0..30 {
            let from = (spike_s - 0.5 * width_s + width_s * 0.01 * f64::from(frame))
                .clamp(0.0, (length_s - width_s).max(0.0));
            dashboard.views.time.x = Some([from, from + width_s]);
            let input = RawInput {
                screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(1280.0, 800.0))),
                ..RawInput::default()
            };
            let (begin, begin_own) = (Instant::now(), ThreadTime::now());
            let mut output = ctx.run_ui(input, |ui| dashboard.ui(ui));
            let shapes = std::mem::take(&mut output.shapes);
            let _ = ctx.tessellate(shapes, 1.0);
            let time_ms = [begin.elapsed(), begin_own.elapsed()].map(|time| 1e3 * time.as_secs_f64());
            raster.take(&mut output.textures_delta);
            if frame >= 3 {
                times_ms.push(time_ms);
            }
        }
        let [wall, own] = [0, 1].map(|k| {
            let mut times: Vec<f64> = times_ms.iter().map(|times: &[f64; 2]| times[k]).collect();
            times.sort_by(f64::total_cmp);
            [times[times.len() / 2], times[times.len() * 9 / 10], times[times.len() - 1]]
        });
        worst = worst.max(own[1]);
        println!(
            "panning {width_s:>12.3} s wide: processor median {:.2} ms, 90 % below {:.2} ms, longest {:.2} ms; wall median {:.2} ms",
            own[0], own[1], own[2], wall[0]
        );
        width_s /= 10.0;
    }
    println!("processor time of a frame while panning, 90 % at the worst zoom: {worst:.2} ms");
}

/// Most memory that this process ever held, kB.
fn high_water_kb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().trim_end_matches(" kB").parse().ok()
}
