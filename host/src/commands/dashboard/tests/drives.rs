//! A drive that is commanded from the window, in real time with a simulated moteus behind a pseudo-terminal: it follows, and is at rest whatever
//! happens.

use std::io::{Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use egui_kittest::kittest::{NodeT, Queryable};
use serialport::{SerialPort, TTYPort};
use socam_core::State;
use socam_recording::Dataset;
use socam_sources::simulators::{Inertia, Mishap, MoteusSimulator, Motor};
use socam_workbench::input_signal::{SignalShape, set_amplitude};

use super::{Attended, Window, click, state, until, window, window_with};

/// Time after which the drive is at rest without its host, s: its watchdog's, and that of braking.
const AT_REST_S: f64 = 0.25 + 0.4;
/// Time after which it is at rest when it was told to stop, s: it coasts.
const COASTED_S: f64 = 1.5;

struct Drive {
    device: String,
    drive: Mutex<MoteusSimulator>,
    arrived: Mutex<Vec<u8>>,
    is_cut: AtomicBool,
    is_over: AtomicBool,
}

impl Drive {
    fn start() -> Arc<Self> {
        let (line, theirs) = TTYPort::pair().unwrap();
        let own = Arc::new(Self {
            device: format!("moteus:{}?id=1", theirs.name().unwrap()),
            drive: Mutex::new(MoteusSimulator::new(1, Motor::at_rest(Inertia::SMALL, 0.1))),
            arrived: Mutex::default(),
            is_cut: AtomicBool::new(false),
            is_over: AtomicBool::new(false),
        });
        let its = Arc::clone(&own);
        std::thread::spawn(move || its.serve(line, theirs));
        own
    }

    fn serve(&self, mut line: TTYPort, theirs: TTYPort) {
        line.set_timeout(Duration::from_millis(1)).unwrap();
        let mut line = Some(line);
        let (begin, mut bytes) = (Instant::now(), [0; 4096]);
        while !self.is_over.load(Ordering::Relaxed) {
            if self.is_cut.load(Ordering::Relaxed) {
                line = None;
                std::thread::sleep(Duration::from_millis(1));
            }
            let count = line.as_mut().and_then(|line| line.read(&mut bytes).ok()).unwrap_or(0);
            self.arrived.lock().unwrap().extend_from_slice(&bytes[..count]);
            let answer = self.now().receive(begin.elapsed().as_secs_f64(), &bytes[..count]);
            if let Some(line) = &mut line {
                let _ = line.write_all(&answer);
            }
        }
        // Kept open, so that no other test gets a terminal of this name while the window still looks for its drive.
        std::mem::forget(theirs);
    }

    fn now(&self) -> MutexGuard<'_, MoteusSimulator> {
        self.drive.lock().unwrap()
    }

    /// The motor is at rest within a time, and stays there.
    fn is_at_rest_within(&self, most_s: f64) {
        let still = |drive: &MoteusSimulator| drive.mode != 10 && drive.motor.speed_rad_s.abs() < 0.2;
        let begin = Instant::now();
        while !still(&self.now()) {
            assert!(begin.elapsed().as_secs_f64() < most_s, "{:?}", self.now());
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(300));
        assert!(still(&self.now()), "{:?}", self.now());
    }
}

/// Ends the thread of a drive with its test, also where that fails.
struct Ending(Arc<Drive>);

impl Drop for Ending {
    fn drop(&mut self) {
        self.0.is_over.store(true, Ordering::Relaxed);
    }
}

/// A window whose drive has limits and a sine of 10 rad/s as its signal.
fn connected(mut window: Window) -> Window {
    click(&mut window, "Connect");
    until(&mut window, "the drive", |window| state(window) == Some(State::Idle));
    let run = &mut window.state_mut().workspace.drive;
    run.set_speed(15.0);
    run.set_effort(socam_workbench::device::Effort::Torque, 0.5);
    run.choose("sine").unwrap();
    let mut settings = run.signal.settings.clone();
    let SignalShape::Other(_, file) = &mut settings.kind else { panic!() };
    set_amplitude(file, 10.0);
    file.duration_s = 30.0;
    run.signal.change(settings);
    until(&mut window, "samples", |window| window.state().workspace.bench.buffer().rows() > 50);
    window
}

/// Arms and runs, and waits until the motor is fast.
fn moving(window: &mut Window, drive: &Drive) {
    click(window, "Arm");
    until(window, "armed", |window| state(window) == Some(State::Armed));
    click(window, "Run");
    until(window, "a fast motor", |_| drive.now().motor.speed_rad_s.abs() > 5.0);
}

fn ended(window: &mut Window) -> (String, String, bool) {
    until(window, "the end", |window| window.state().workspace.bench.ended().is_some());
    let (path, text, well) = window.state().workspace.bench.ended().unwrap();
    (path.display().to_string(), text.to_owned(), well)
}

fn drive_in_window(folder: &Path) -> (Window, Ending) {
    let drive = Drive::start();
    (connected(window(&drive.device, folder, 200.0)), Ending(drive))
}

#[test]
fn a_drive_is_armed_without_a_command_runs_stops_gently_and_is_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let (mut own, ending) = drive_in_window(folder.path());
    let (window, drive) = (&mut own, &ending.0);
    window.get_by_label_contains("a weight falls");
    click(window, "Arm");
    until(window, "armed", |window| state(window) == Some(State::Armed));
    window.get_by_label_contains("largest torque of 0.5 N m");
    std::thread::sleep(Duration::from_millis(200));
    window.run_steps(3);
    assert_eq!(drive.now().commands, 0, "nothing but questions has left");
    let text = String::from_utf8(drive.arrived.lock().unwrap().clone()).unwrap();
    let first = text.lines().next().unwrap();
    assert!(text.lines().filter(|line| line.len() > 10).all(|line| line == first || line.ends_with(first)));
    // A stop disarms.
    click(window, "Stop");
    until(window, "at rest", |window| state(window) == Some(State::Idle));
    moving(window, drive);
    let limits: Vec<_> = (0..9).map(|channel| window.state().workspace.bench.limit(channel)).collect();
    assert_eq!(limits, [None, None, Some(15.0), Some(0.5), None, None, None, None, Some(15.0)]);
    window.state_mut().workspace.bench.note("it hums".into());
    std::thread::sleep(Duration::from_millis(300));
    click(window, "Stop");
    let (path, text, well) = ended(window);
    assert!(well && text.contains("stopped by the operator") && text.contains("commands left"), "{text}");
    drive.is_at_rest_within(COASTED_S);
    until(window, "at rest", |window| state(window) == Some(State::Idle));
    let before = window.state().workspace.bench.buffer().rows();
    until(window, "questions again", |window| window.state().workspace.bench.buffer().rows() > before + 50);
    let data = Dataset::open(&path).unwrap();
    let command = data.load(&["command"]).unwrap();
    assert!(command.columns[0].values().iter().any(|value| *value > 5.0));
    let log = data.contents().unwrap();
    assert!(
        log.metadata["limits"] == "15 rad/s, 0.5 N m" && log.events.iter().any(|own| own.text == "it hums")
    );
    assert!(log.attachments.iter().any(|own| own.name == "profile.toml"));
    // What was drawn before the run is still there, and times go on.
    assert!(window.state().workspace.bench.buffer().holes().len() < 3);
}

#[test]
fn the_emergency_stop_stops_a_drive_at_once_in_every_view_and_window() {
    let folder = tempfile::tempdir().unwrap();
    let (mut window, ending) = drive_in_window(folder.path());
    let drive = &ending.0;
    for (number, view) in ["Live", "Time", "Diagnosis"].into_iter().enumerate() {
        moving(&mut window, drive);
        click(&mut window, view);
        if number == 2 {
            // A view in a window of its own has a stop of its own.
            window.key_press_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Key::O);
            window.run_steps(3);
        }
        window.key_press(egui::Key::Escape);
        window.run_steps(1);
        let pressed = Instant::now();
        while drive.now().mode == 10 {
            assert!(pressed.elapsed() < Duration::from_secs(1), "{view}: {:?}", drive.now());
            std::thread::sleep(Duration::from_millis(1));
        }
        let (_, text, _) = ended(&mut window);
        assert!(text.contains("stopped by the operator"), "{text}");
        drive.is_at_rest_within(COASTED_S);
        until(&mut window, "at rest", |window| state(window) == Some(State::Idle));
        click(&mut window, "Live");
    }
}

#[test]
fn a_cable_that_is_pulled_in_mid_run_leaves_the_drive_at_rest_and_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let (mut window, ending) = drive_in_window(folder.path());
    let drive = &ending.0;
    moving(&mut window, drive);
    drive.is_cut.store(true, Ordering::Relaxed);
    drive.is_at_rest_within(AT_REST_S);
    let (path, text, well) = ended(&mut window);
    let is_told = ["broke while it moved", "the drive has not answered for 0."];
    assert!(!well && is_told.iter().any(|told| text.contains(told)), "{text}");
    assert!(Dataset::open(&path).unwrap().rows() > 20);
    assert!(window.state().workspace.bench.problem().is_some());
}

#[test]
fn a_window_that_is_closed_in_mid_run_stops_the_drive_and_closes_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let drive = Ending(Drive::start());
    let attended = Attended::default();
    let mut window = connected(window_with(&attended, &drive.0.device, folder.path(), 200.0));
    moving(&mut window, &drive.0);
    std::thread::sleep(Duration::from_millis(300));
    drop(window);
    assert!(attended.wait(Duration::from_secs(8)), "the thread ends");
    assert_eq!(drive.0.now().mode, 0, "it was told to stop, before its watchdog");
    drive.0.is_at_rest_within(COASTED_S);
    let path = folder.path().join("run-1.mcap").display().to_string();
    let data = Dataset::open(&path).unwrap();
    assert!(data.rows() > 50 && !data.contents().unwrap().events.is_empty());
}

#[test]
fn a_fault_of_the_drive_is_said_and_what_passes_the_limits_is_not_armed() {
    let folder = tempfile::tempdir().unwrap();
    let (mut window, ending) = drive_in_window(folder.path());
    let drive = &ending.0;
    moving(&mut window, drive);
    drive.now().mishap = Some(Mishap::Fault(34));
    let (_, text, well) = ended(&mut window);
    assert!(!well && text.contains("fault 34 (over-voltage)"), "{text}");
    assert!(window.query_all_by_label_contains("over-voltage").count() > 0);
    drive.now().mishap = None;
    let before = drive.now().commands;
    // An opened profile keeps its own size, whatever the limit is.
    let toml = "schema = \"socam.profile/1\"\ncommand = \"speed\"\nshape = \"constant\"\nlevel_rad_s = 20\nlimit_rad_s = 25\nslew_rad_s2 = 100\nduration_s = 5\n";
    let file = socam_recording::ProfileFile::parse(toml).unwrap();
    window.state_mut().workspace.take_signal(&file).unwrap();
    click(&mut window, "Arm");
    let refused = "reaches 20 rad/s, beyond the limit of 15 rad/s";
    until(&mut window, "a refusal", |window| window.query_by_label_contains(refused).is_some());
    assert!(window.get_by_label("Run").accesskit_node().is_disabled());
    assert_eq!(drive.now().commands, before);
}
