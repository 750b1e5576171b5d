//! The live view of devices that are not the own board: shown, recorded by a press, gone and back again, and watched.

use std::io::{Read, Write};
use std::net::{TcpListener, UdpSocket};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use egui_kittest::kittest::{NodeT, Queryable};
use serialport::{SerialPort, TTYPort};
use socam_dashboard::View;
use socam_recording::{Dataset, Unit};
use socam_sources::simulators::{Inertia, MoteusSimulator, Motor};

use super::{Window, click, until, window};

/// What a device of the test is told, from one end of it to the other.
#[derive(Clone, Default)]
struct Switch {
    is_off: Arc<AtomicBool>,
    is_over: Arc<AtomicBool>,
}

impl Switch {
    fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    fn is_off(&self) -> bool {
        self.is_off.load(Ordering::Relaxed)
    }

    fn turn(&self, is_on: bool) {
        self.is_off.store(!is_on, Ordering::Relaxed);
    }
}

/// Ends the device when the test ends, also where it fails.
impl Drop for Switch {
    fn drop(&mut self) {
        // The device's own copy is dropped by its thread, which has ended then.
        if Arc::strong_count(&self.is_over) <= 2 {
            self.is_over.store(true, Ordering::Relaxed);
        }
    }
}

/// Time between two rows of a device of text.
const STEP: Duration = Duration::from_millis(2);

/// A server of TCP that sends a row every 2 ms by its clock, after a line of names, to whoever connects while it is on.
fn text_device(names: &'static str, row: impl Fn(u64) -> String + Send + 'static) -> (String, Switch) {
    let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let switch = Switch::default();
    let theirs = switch.clone();
    std::thread::spawn(move || {
        let begin = Instant::now();
        let mut sent = 0;
        while !theirs.is_over() {
            std::thread::sleep(STEP);
            if theirs.is_off() {
                continue;
            }
            let Ok(listener) = TcpListener::bind(address) else { continue };
            listener.set_nonblocking(true).unwrap();
            let connected = || {
                while !theirs.is_over() && !theirs.is_off() {
                    if let Ok((line, _)) = listener.accept() {
                        return Some(line);
                    }
                    std::thread::sleep(STEP);
                }
                None
            };
            let Some(mut line) = connected() else { continue };
            line.write_all(names.as_bytes()).unwrap();
            sent = sent.max((begin.elapsed().as_micros() / STEP.as_micros()) as u64);
            while !theirs.is_over() && !theirs.is_off() {
                std::thread::sleep((begin + STEP * sent as u32).saturating_duration_since(Instant::now()));
                if line.write_all(row(sent).as_bytes()).is_err() {
                    break;
                }
                sent += 1;
            }
        }
    });
    (format!("text+tcp:{address}"), switch)
}

fn connect(device: &str, folder: &Path) -> Window {
    let mut window = window(device, folder, 200.0);
    click(&mut window, "Connect");
    shows(&mut window, 200);
    window
}

fn shows(window: &mut Window, rows: usize) {
    until(window, "samples", |window| window.state().workspace.bench.buffer().rows() > rows);
}

/// Ends the recording, and returns its file and what is said of it.
fn end(window: &mut Window) -> (String, String) {
    click(window, "End");
    until(window, "the end", |window| window.state().workspace.bench.ended().is_some());
    let (path, text, _) = window.state().workspace.bench.ended().unwrap();
    (path.display().to_string(), text.to_owned())
}

#[test]
fn a_device_of_text_is_recorded_by_a_press_and_goes_on_when_it_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let row = |k: u64| format!("{},{k},{},0.25\n", 2000 * k, k % 100);
    let (device, switch) = text_device("t_us,seq,motor_speed_rad_s,torque_Nm\n", row);
    let mut window = connect(&device, folder.path());
    window.get_by_label("Chart motor_speed, rad/s");
    window.get_by_label("receive only: no commands are sent");
    window.get_by_label("listening");
    window.get_by_label_contains("none lost");
    window.state_mut().workspace.next_run.note = "bare shaft".into();
    click(&mut window, "Record");
    until(&mut window, "a recording", |window| window.state().workspace.bench.is_recording());
    std::thread::sleep(Duration::from_millis(600));
    switch.turn(false);
    until(&mut window, "a broken link", |window| {
        window.query_by_label_contains("it is opened again").is_some()
    });
    window.get_by_label("no samples, recording");
    std::thread::sleep(Duration::from_millis(400));
    let before = window.state().workspace.bench.buffer().rows();
    switch.turn(true);
    shows(&mut window, before + 300);
    window.state_mut().workspace.bench.note("it is back".into());
    shows(&mut window, before + 500);
    let (path, text) = end(&mut window);
    assert!(text.contains("counted by the device's numbers") && text.contains("1 interruptions"), "{text}");
    let bench = &window.state().workspace.bench;
    let [missed, gaps] = bench.buffer().missed();
    assert!(missed > 200 && gaps == 1, "{missed} {gaps}");
    let kinds: Vec<_> = bench.events().iter().map(|event| event.kind.as_str()).collect();
    assert_eq!(kinds, ["start", "fault", "note", "note"]);
    let data = Dataset::open(&path).unwrap();
    assert_eq!(data.lost_samples(), missed);
    let log = data.contents().unwrap();
    assert_eq!(
        (log.metadata["note"].as_str(), log.metadata["device"].as_str()),
        ("bare shaft", device.as_str())
    );
    assert!(log.events.iter().any(|event| event.text == "it is back"), "{:?}", log.events);
    // No sample is wrong: the speed is that of its time.
    let loaded = data.load(&["motor_speed"]).unwrap();
    let values = loaded.columns[0].values();
    let first = values[0] + 0.5;
    for (time_s, value) in loaded.time_s.iter().zip(values) {
        assert!(((first + time_s / 0.002) % 100.0 - 0.5 - value).abs() < 0.1, "{time_s} {value}");
    }
}

/// A unit in a description that is to be completed.
const UNKNOWN: &str = "unit = \"?\"";

/// What a device does not state is drawn as it comes and not recorded, until its description is complete.
#[test]
fn plain_numbers_are_drawn_and_their_description_is_written_completed_and_used() {
    let folder = tempfile::tempdir().unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let switch = Switch::default();
    let theirs = switch.clone();
    std::thread::spawn(move || {
        let mut sender = UdpSocket::bind("127.0.0.1:0").unwrap();
        for k in 0.. {
            std::thread::sleep(STEP);
            if theirs.is_over() {
                return;
            }
            if theirs.is_off() {
                // A program that begins anew sends from another port.
                sender = UdpSocket::bind("127.0.0.1:0").unwrap();
                continue;
            }
            let _ = sender.send_to(format!("enc:{k},load:{}\n", k % 7).as_bytes(), port);
        }
    });
    let mut window = connect(&format!("udp:{port}"), folder.path());
    window.get_by_label("Chart enc");
    assert!(window.query_all_by_label_contains("does not state the unit of `enc`").count() > 0);
    assert!(window.get_by_label("Record").accesskit_node().is_disabled());
    click(&mut window, "Write description");
    let file = folder.path().join("device-1.toml");
    until(&mut window, "the file", |_| file.exists());
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replacen(UNKNOWN, "unit = \"rad\"", 1).replacen(UNKNOWN, "unit = \"N m\"", 1))
        .unwrap();
    click(&mut window, "Disconnect");
    until(&mut window, "an end", |window| !window.state().workspace.bench.is_linked());
    click(&mut window, "Connect");
    shows(&mut window, 200);
    window.get_by_label("Chart load, N m");
    click(&mut window, "Record");
    until(&mut window, "a recording", |window| window.state().workspace.bench.is_recording());
    let before = window.state().workspace.bench.buffer().rows();
    switch.turn(false);
    until(&mut window, "silence", |window| window.query_by_label_contains("has been silent for").is_some());
    switch.turn(true);
    shows(&mut window, before + 100);
    assert_eq!(window.state().workspace.bench.buffer().holes().len(), 1, "a pause is shaded");
    let (path, text) = end(&mut window);
    assert!(text.contains("times are those of arrival"), "{text}");
    let data = Dataset::open(&path).unwrap();
    assert_eq!(data.channels()[0].unit, Unit::Rad);
    let attached = &data.contents().unwrap().attachments;
    assert!(attached.iter().any(|own| own.name == "device.toml"), "{attached:?}");
}

#[test]
fn a_drive_that_is_not_armed_is_asked_and_never_commanded() {
    let folder = tempfile::tempdir().unwrap();
    let (mut line, theirs) = TTYPort::pair().unwrap();
    let device = format!("moteus:{}?id=1", theirs.name().unwrap());
    let switch = Switch::default();
    let ended = switch.clone();
    let drive = std::thread::spawn(move || {
        line.set_timeout(Duration::from_millis(1)).unwrap();
        let mut drive = MoteusSimulator::new(1, Motor::at_rest(Inertia::SMALL, 0.1));
        let (begin, mut bytes, mut arrived) = (Instant::now(), [0; 4096], Vec::new());
        while !ended.is_over() {
            let count = line.read(&mut bytes).unwrap_or(0);
            arrived.extend_from_slice(&bytes[..count]);
            let answer = drive.receive(begin.elapsed().as_secs_f64(), &bytes[..count]);
            let _ = line.write_all(&answer);
        }
        arrived
    });
    let mut window = connect(&device, folder.path());
    window.get_by_label_contains("asked only: Arm compares");
    window.get_by_label_contains("which is only asked");
    assert!(window.get_by_label("Arm").accesskit_node().is_disabled(), "no limits are set");
    window.get_by_label("Chart speed, rad/s");
    // Neither stop nor keys make anything leave.
    window.key_press(egui::Key::Escape);
    window.run_steps(3);
    click(&mut window, "Record");
    until(&mut window, "a recording", |window| window.state().workspace.bench.is_recording());
    let before = window.state().workspace.bench.buffer().rows();
    shows(&mut window, before + 100);
    let (path, text) = end(&mut window);
    assert!(text.contains("times are those of arrival"), "{text}");
    let data = Dataset::open(&path).unwrap();
    let speed = data.load(&["speed"]).unwrap();
    assert!(speed.columns[0].values().iter().all(|speed| *speed == 0.0));
    assert!(data.contents().unwrap().metadata["device_kind"].contains("moteus"));
    click(&mut window, "Disconnect");
    until(&mut window, "an end", |window| !window.state().workspace.bench.is_linked());
    switch.is_over.store(true, Ordering::Relaxed);
    let arrived = String::from_utf8(drive.join().unwrap()).unwrap();
    let mut questions: Vec<&str> = arrived.lines().collect();
    questions.sort_unstable();
    questions.dedup();
    assert_eq!(questions.len(), 1, "one question and nothing else: {questions:?}");
}

/// A change of a machine whose sensors come as text raises an alarm in every view, which leads to a diagnosis of what was recorded since.
#[test]
fn an_alarm_of_a_watched_device_leads_to_a_diagnosis_from_any_view() {
    #[derive(clap::Parser)]
    struct Simulation {
        #[command(flatten)]
        args: crate::commands::simulate::Args,
    }
    let folder = tempfile::tempdir().unwrap();
    let simulated = |name: &str, more: &[&str]| {
        let path = folder.path().join(name).display().to_string();
        let words = ["", "--profile", "multisine", "--rate", "500", "-o", &path];
        let simulation: Simulation = clap::Parser::parse_from(words.iter().chain(more));
        crate::commands::simulate::run(simulation.args).unwrap();
        path
    };
    let healthy = simulated("healthy.mcap", &["--duration", "40s"]);
    let friction = "coulomb_friction@load_bearing:torque=0.1";
    let changed = simulated(
        "changed.mcap",
        &["--duration", "30s", "--seed", "3", "--hide", friction, "--begin-at", "8s"],
    );
    let data = Dataset::open(&changed).unwrap();
    let names: Vec<String> = data.channels().iter().map(|channel| channel.column_name()).collect();
    let names: &'static str = Box::leak(format!("t_us,{}\n", names.join(",")).into_boxed_str());
    let plain: Vec<String> = data.channels().iter().map(|channel| channel.name.clone()).collect();
    let loaded = data.load(&plain.iter().map(String::as_str).collect::<Vec<_>>()).unwrap();
    let (device, switch) = text_device(names, move |k| {
        let row = (k as usize).min(loaded.time_s.len() - 1);
        let values = loaded.columns.iter().map(|column| column.values()[row].to_string());
        format!("{},{}\n", 2000 * k, values.collect::<Vec<_>>().join(","))
    });
    let mut window = window(&device, folder.path(), 500.0);
    click(&mut window, "Connect");
    window.state_mut().open([healthy]);
    window.state_mut().watch();
    shows(&mut window, 10);
    click(&mut window, "Live");
    click(&mut window, "Record");
    until(&mut window, "an alarm", |window| !window.state().views.watch.alarms().is_empty());
    click(&mut window, "Time");
    until(&mut window, "the notice", |window| window.query_by_label_contains("Alarm 1 at").is_some());
    window.get_by_label("Watch: 1 alarm");
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(4) {
        std::thread::sleep(Duration::from_millis(20));
        window.run_steps(1);
    }
    click(&mut window, "Diagnose from here");
    let opened = |window: &Window| {
        let mut names =
            window.state().workspace.entries.iter().map(|entry| entry.recording.about.name.clone());
        names.find(|name| name.contains("run-1.mcap@"))
    };
    until(&mut window, "the part since the change", |window| opened(window).is_some());
    assert_eq!(window.state().layout.view, View::Diagnosis);
    let [alarm] = window.state().views.watch.alarms() else { panic!() };
    let entry = window.state().workspace.entries.last().unwrap();
    let [from_s, to_s] = entry.recording.samples.span_s().unwrap();
    assert!(to_s - from_s > 1.5, "{from_s} {to_s} {alarm:?}");
    assert!(window.state().workspace.bench.is_recording(), "the recording goes on");
    drop(switch);
}
