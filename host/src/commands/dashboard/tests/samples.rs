//! The picture lacks no sample of a run.

use std::time::Duration;

use socam_core::State;
use socam_recording::Dataset;

use super::{Window, connected, running, six_channels, state};

/// A window that draws five pictures a second.
fn draw(window: &mut Window, pictures: u32) {
    for _ in 0..pictures {
        std::thread::sleep(Duration::from_millis(200));
        window.run_steps(1);
    }
}

/// Runs two seconds, presses the emergency stop, and compares the window's samples with the recorded ones.
fn every_sample_is_shown(mut window: Window, step_s: f64) {
    running(&mut window);
    draw(&mut window, 10);
    window.key_press(egui::Key::Escape);
    let ends = |window: &Window| window.state().workspace.bench.ended().is_some();
    while !(ends(&window) && state(&window) == Some(State::Fault)) {
        draw(&mut window, 1);
    }
    draw(&mut window, 3);
    let live = &window.state().workspace.bench;
    let (path, text, _) = live.ended().unwrap();
    let data = Dataset::open(&path.display().to_string()).unwrap();
    let rows = data.rows() as usize;
    assert!(rows as f64 * step_s > 1.5 && data.lost_samples() == 0, "{text}");
    let at = |kind: &str| live.events().iter().find(|event| event.kind == kind).unwrap().time_s;
    let begin_s = at("start");
    let span_s = [begin_s - 0.5 * step_s, begin_s + (rows as f64 - 0.5) * step_s];
    let recorded = data.load_all().unwrap();
    for (channel, column) in recorded.columns.iter().enumerate() {
        let same = |(shown, recorded): (&f32, &f64)| {
            *shown == *recorded as f32 || (shown.is_nan() && recorded.is_nan())
        };
        let shown = live.buffer().values(channel, span_s);
        assert_eq!(shown.len(), rows, "channel {channel}");
        assert!(shown.iter().zip(column.values()).all(same), "channel {channel}");
    }
    assert_eq!(live.buffer().missed(), [0, 0]);
    assert!((at("fault") - span_s[1]).abs() < step_s, "the fault is marked at the run's last sample");
    // The picture goes on after the stop without a gap.
    let after = live.buffer().values(0, [span_s[1], span_s[1] + 0.2]);
    assert!((after.len() as f64 * step_s - 0.2).abs() < 2.0 * step_s, "{}", after.len());
}

#[test]
fn every_sample_between_run_and_emergency_stop_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    every_sample_is_shown(connected("sim", folder.path(), 1000.0), 1e-3);
}

#[test]
fn every_sample_of_six_channels_at_ten_kilohertz_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    every_sample_is_shown(six_channels(folder.path()), 1e-4);
}
