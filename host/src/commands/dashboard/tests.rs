//! The live view at the virtual bench: connect, arm, run, stop, emergency stop.

#[cfg(unix)]
mod drives;
mod failures;
mod samples;
#[cfg(unix)]
mod sources;

use std::path::Path;
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use socam_core::State;
use socam_dashboard::{Dashboard, Layout, View};
use socam_job::VirtualBench;
use socam_recording::Dataset;
use socam_workbench::input_signal::Settings;

use super::attended::Attended;
use super::{bench, simulated};

type Window = Harness<'static, Dashboard>;

fn window(device: &str, folder: &Path, rate_hz: f64) -> Window {
    window_at("speed-o-cam", device, folder, rate_hz)
}

/// A window whose devices are counted while they are attended to.
#[cfg(unix)]
fn window_with(attended: &Attended, device: &str, folder: &Path, rate_hz: f64) -> Window {
    opened("speed-o-cam", attended, device, folder, rate_hz)
}

/// A window whose virtual bench is another model's.
fn window_at(model: &str, device: &str, folder: &Path, rate_hz: f64) -> Window {
    opened(model, &Attended::default(), device, folder, rate_hz)
}

fn opened(model: &str, attended: &Attended, device: &str, folder: &Path, rate_hz: f64) -> Window {
    let layout = Layout { view: View::Live, device: device.into(), ..Layout::default() };
    let mut dashboard = Dashboard::new(layout);
    let bench = VirtualBench { model: model.into(), ..socam_job::options::defaults().unwrap() };
    dashboard.workspace.bench.connect_by(bench::connector(bench, None, None, attended));
    dashboard.simulate_by(simulated::simulated);
    dashboard.workspace.next_run.folder = folder.into();
    dashboard.workspace.next_run.rate_hz = rate_hz;
    let harness = Harness::builder().with_size([1280.0, 800.0]).with_step_dt(0.02);
    let mut window = harness.build_ui_state(|ui, dashboard: &mut Dashboard| dashboard.ui(ui), dashboard);
    window.run_steps(2);
    window
}

fn until(window: &mut Window, what: &str, is: impl Fn(&Window) -> bool) {
    let begin = Instant::now();
    while !is(window) {
        assert!(begin.elapsed() < Duration::from_secs(60), "waited for {what}");
        std::thread::sleep(Duration::from_millis(20));
        window.run_steps(1);
    }
}

fn click(window: &mut Window, label: &str) {
    let is_no_text = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() != egui::Role::Label;
    let found = window.get_all_by_label(label).find(is_no_text);
    found.unwrap_or_else(|| panic!("nothing to click is called {label}")).click();
    window.run_steps(3);
}

fn state(window: &Window) -> Option<State> {
    window.state().workspace.bench.state()
}

fn connected(device: &str, folder: &Path, rate_hz: f64) -> Window {
    connect(window(device, folder, rate_hz))
}

fn connect(mut window: Window) -> Window {
    click(&mut window, "Connect");
    until(&mut window, "the board", |window| state(window) == Some(State::Idle));
    until(&mut window, "samples", |window| window.state().workspace.bench.buffer().rows() > 200);
    window
}

fn running(window: &mut Window) {
    click(window, "Arm");
    until(window, "armed", |window| state(window) == Some(State::Armed));
    click(window, "Run");
    until(window, "running", |window| state(window) == Some(State::Running));
}

#[test]
fn a_run_is_armed_started_stopped_and_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = connected("sim", folder.path(), 1000.0);
    window.get_by_label("Chart motor_speed, rad/s");
    running(&mut window);
    std::thread::sleep(Duration::from_millis(400));
    window.get_by_label("Note").focus();
    window.run_steps(1);
    window.get_by_label("Note").type_text("coupling 2 squeaks");
    window.run_steps(2);
    click(&mut window, "Add");
    std::thread::sleep(Duration::from_millis(400));
    click(&mut window, "Stop");
    until(&mut window, "the end", |window| window.state().workspace.bench.ended().is_some());
    let (path, text, well) = window.state().workspace.bench.ended().unwrap();
    assert!(well && text.starts_with("stopped by the operator") && text.contains("none lost"), "{text}");
    let data = Dataset::open(&path.display().to_string()).unwrap();
    assert!(data.rows() > 500 && data.lost_samples() == 0, "{}", data.rows());
    let events = &data.contents().unwrap().events;
    assert!(events.iter().any(|event| event.kind == "stop"));
    let is_note = |event: &&socam_recording::Event| event.text == "coupling 2 squeaks";
    let note = events.iter().find(is_note).unwrap_or_else(|| panic!("{events:?}"));
    assert!(note.kind == "note" && note.device_time_ns > 100_000_000, "{note:?}");
    until(&mut window, "rest", |window| state(window) == Some(State::Idle));
    click(&mut window, "Look at the recording");
    until(&mut window, "the recording", |window| !window.state().is_busy());
    assert_eq!(window.state().layout.view, View::Time);
    window.run_steps(2);
    window.get_by_label("run-1.mcap");
}

#[test]
fn the_emergency_stop_cuts_the_command_from_any_view_by_its_key() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = connected("sim", folder.path(), 1000.0);
    running(&mut window);
    click(&mut window, "Diagnosis");
    window.key_press(egui::Key::Escape);
    window.run_steps(1);
    until(&mut window, "the end", |window| window.state().workspace.bench.ended().is_some());
    let (path, text, _) = window.state().workspace.bench.ended().unwrap();
    assert!(text.contains("emergency") || text.contains("stopped"), "{text}");
    let command = Dataset::open(&path.display().to_string()).unwrap().load(&["command"]).unwrap();
    let values = command.columns[0].values();
    assert_eq!(values.last(), Some(&0.0));
    click(&mut window, "Live");
    until(&mut window, "the fault", |window| state(window) == Some(State::Fault));
    click(&mut window, "Clear fault");
    until(&mut window, "rest", |window| state(window) == Some(State::Idle));
}

#[test]
fn a_press_on_the_emergency_stop_acts_while_a_dialog_is_open() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = connected("sim", folder.path(), 1000.0);
    running(&mut window);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::O);
    window.run_steps(2);
    window.get_by_label("Cancel");
    let pos = window.get_by_label("EMERGENCY STOP").rect().center();
    let button = egui::PointerButton::Primary;
    let press = egui::Event::PointerButton { pos, button, pressed: true, modifiers: egui::Modifiers::NONE };
    window.event(egui::Event::PointerMoved(pos));
    window.event(press);
    window.run_steps(1);
    until(&mut window, "the end", |window| window.state().workspace.bench.ended().is_some());
    until(&mut window, "the fault", |window| state(window) == Some(State::Fault));
}

#[test]
fn a_rehearsal_moves_the_virtual_bench_only_and_is_recorded_and_drawn() {
    #[derive(clap::Parser)]
    struct Words {
        #[command(flatten)]
        args: super::Args,
    }
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let (picture, records) = (place("live.png"), place(""));
    let dashboard = |device: &str| {
        let words =
            ["", "--rehearse", "2", "--screenshot", &picture, "--record-into", &records, "--device", device];
        super::run(<Words as clap::Parser>::parse_from(words).args)
    };
    let refused = dashboard("tcp:127.0.0.1:1").unwrap_err().to_string();
    assert!(refused.contains("virtual bench only"), "{refused}");
    assert!(!Path::new(&picture).exists());
    dashboard("sim").unwrap();
    assert!(std::fs::read(&picture).unwrap().len() > 50_000);
    let data = Dataset::open(&place("run-1.mcap")).unwrap();
    assert!(data.rows() >= 2000 && data.cut().is_none() && data.lost_samples() == 0, "{}", data.rows());
}

#[test]
fn what_the_model_makes_of_a_recordings_inputs_lies_over_it_and_differs_by_its_noise() {
    #[derive(clap::Parser)]
    struct Simulation {
        #[command(flatten)]
        args: crate::commands::simulate::Args,
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap").display().to_string();
    let words = ["", "--profile", "steps", "--duration", "4s", "-o", &path];
    crate::commands::simulate::run(<Simulation as clap::Parser>::parse_from(words).args).unwrap();
    let mut window = window("sim", folder.path(), 1000.0);
    window.state_mut().open([path.clone()]);
    until(&mut window, "the recording", |window| !window.state().is_busy());
    click(&mut window, "File");
    click(&mut window, "Simulate the shown recordings");
    until(&mut window, "the simulation", |window| !window.state().is_busy());
    window.run_steps(2);
    assert_eq!(window.state().problems().collect::<Vec<_>>(), Vec::<&str>::new());
    window.get_by_label("run.mcap simulated by speed-o-cam");
    window.state_mut().views.time.reference = Some(0);
    window.run_steps(2);
    window.get_by_label("Chart torque_out minus run.mcap, N m");

    let model = socam_model::Model::builtin("speed-o-cam").unwrap();
    let recording = window.state().workspace.entries[0].recording.clone();
    let simulated = simulated::simulated(&model, &recording).unwrap();
    let channel = simulated.about.channels.iter().position(|channel| channel.name == "torque_out").unwrap();
    let values = simulated.samples.values(channel, 0..simulated.samples.rows());
    let recorded = Dataset::open(&path).unwrap().load(&["torque_out"]).unwrap();
    let squares = recorded.columns[0].values().iter().zip(&values).map(|(a, b)| (a - b).powi(2));
    let rms = (squares.sum::<f64>() / values.len() as f64).sqrt();
    assert!(values.len() > 3900 && rms < 0.03, "{rms} N m over {} samples", values.len());
}

/// A window whose virtual bench has six channels, sampled at 10 kHz.
fn six_channels(folder: &Path) -> Window {
    let model = folder.join("six.toml");
    let sixth = "[channels.cam_speed]\nrole = \"output\"\nquantity = \"speed\"\nat = \"cam_shaft\"\n";
    std::fs::write(&model, format!("{}{sixth}", socam_job::model_text("speed-o-cam").unwrap())).unwrap();
    connect(window_at(&model.display().to_string(), "sim", folder, 10_000.0))
}

/// Prints frames per second in software rendering while six channels at ten thousand samples a second are recorded and shown.
#[test]
fn six_channels_at_ten_kilohertz_are_recorded_whole_while_they_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = six_channels(folder.path());
    let long = Settings { duration_s: 60.0, ..Settings::default() };
    window.state_mut().workspace.signal.change(long);
    running(&mut window);
    // The charts show the last ten seconds, so the test waits until these are filled.
    let full = 90_000;
    until(&mut window, "a full picture", |window| window.state().workspace.bench.buffer().rows() > full);
    let begin = Instant::now();
    let mut spent = Duration::ZERO;
    let mut frames = 0;
    let part = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 800.0));
    while begin.elapsed() < Duration::from_secs(3) {
        let own = cpu_time::ThreadTime::now();
        window.run_steps(1);
        let shapes = window.output().shapes.clone();
        let _ = socam_chart::raster::of_shapes(&window.ctx, shapes, part, egui::Color32::BLACK);
        spent += own.elapsed();
        frames += 1;
    }
    let rate = f64::from(frames) / begin.elapsed().as_secs_f64();
    // A window that hangs loses no samples, and neither does its recording.
    std::thread::sleep(Duration::from_secs(4));
    let own_ms = 1e3 * spent.as_secs_f64() / f64::from(frames);
    click(&mut window, "Stop");
    until(&mut window, "the end", |window| window.state().workspace.bench.ended().is_some());
    let (path, text, well) = window.state().workspace.bench.ended().unwrap();
    assert!(well, "{text}");
    let data = Dataset::open(&path.display().to_string()).unwrap();
    assert_eq!((data.lost_samples(), data.channels().len()), (0, 6));
    assert_eq!(window.state().workspace.bench.buffer().missed(), [0, 0]);
    println!(
        "measured: live, six channels at 10 kHz: {own_ms:.1} ms of one processor per frame of 1280x800 drawn in software ({rate:.0} frames/s beside all other tests), {text}"
    );
}
