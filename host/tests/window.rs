//! The dashboard's real window on a virtual display, driven by keyboard and mouse. What happened is read from the window's title,
//! which tells the state of the bench, and from the recordings.
#![cfg(all(feature = "window-tests", target_os = "linux"))]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use socam_recording::{Dataset, Event};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat};
use x11rb::rust_connection::RustConnection;

/// Longest time for a change of state.
const PATIENCE: Duration = Duration::from_secs(20);
const SIZE: [i16; 2] = [1280, 800];

/// A program that ends with its value.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A virtual display with a keyboard and a mouse.
struct Display {
    name: String,
    screen: RustConnection,
    _server: Running,
}

impl Display {
    /// `None`, with the reason said, where there is none.
    fn start() -> Option<Self> {
        let has = |name: &str, argument: &str| {
            let quiet = Command::new(name).arg(argument).stdout(Stdio::null()).stderr(Stdio::null()).status();
            quiet.is_ok()
        };
        if !has("Xvfb", "-help") || !has("xdotool", "version") {
            eprintln!("skipped: Xvfb or xdotool is missing, with which the real window is tried");
            return None;
        }
        let screen = format!("{}x{}x24", SIZE[0], SIZE[1]);
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &screen, "-nolisten", "tcp"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let name = format!(":{}", number.trim());
        let screen = x11rb::connect(Some(&name)).unwrap().0;
        Some(Self { name, screen, _server: Running(server) })
    }

    fn xdotool(&self, arguments: &[&str]) -> String {
        let said = Command::new("xdotool").args(arguments).env("DISPLAY", &self.name).output().unwrap();
        String::from_utf8(said.stdout).unwrap().trim().to_owned()
    }

    /// A pixel at the lower left, where nothing but the panel is, and what lies over it.
    fn corner(&self) -> Vec<u8> {
        let root = self.screen.setup().roots[0].root;
        let image = self.screen.get_image(ImageFormat::Z_PIXMAP, root, 3, SIZE[1] - 4, 1, 1, u32::MAX);
        image.unwrap().reply().unwrap().data
    }
}

fn until(what: &str, is: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is() {
        assert!(begin.elapsed() < PATIENCE, "waited for {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The dashboard, connected to the virtual bench.
struct Window<'d> {
    display: &'d Display,
    id: String,
    _program: Running,
}

impl<'d> Window<'d> {
    fn open(display: &'d Display, folder: &Path) -> Self {
        let size = format!("{}x{}", SIZE[0], SIZE[1]);
        let program = Command::new(env!("CARGO_BIN_EXE_socam-host"))
            .args([
                "dashboard",
                "--device",
                "sim",
                "--view",
                "live",
                "--dark",
                "--size",
                &size,
                "--record-into",
            ])
            .arg(folder)
            .env("DISPLAY", &display.name)
            .env("XDG_CONFIG_HOME", folder)
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .stdin(Stdio::null())
            .spawn()
            .unwrap();
        let program = Running(program);
        let find = || display.xdotool(&["search", "--name", "^socam: idle$"]);
        until("a window whose bench is idle", || !find().is_empty());
        let window = Self { display, id: find(), _program: program };
        // No window manager gives it the keyboard.
        display.xdotool(&["windowfocus", "--sync", &window.id]);
        window
    }

    fn is(&self, state: &str) {
        let title = || self.display.xdotool(&["getwindowname", &self.id]);
        until(&format!("{state}; it is {}", title()), || title() == format!("socam: {state}"));
    }

    fn keys(&self, keys: &str) {
        self.display.xdotool(&["key", keys]);
    }

    fn run(&self) {
        self.keys("ctrl+shift+a");
        self.is("armed");
        self.keys("ctrl+shift+r");
        self.is("running, recording");
    }

    /// Opens a dialog, whose backdrop darkens the whole window.
    fn open_dialog(&self) {
        let before = self.display.corner();
        self.keys("ctrl+o");
        until("a dialog", || self.display.corner() != before);
    }
}

/// Events of a recording, and its last command, V.
fn recorded(path: &Path) -> (Vec<Event>, f64) {
    let data = Dataset::open(path.to_str().unwrap()).unwrap();
    assert!(data.is_complete() && data.rows() > 50, "{}: {} rows", path.display(), data.rows());
    let command = data.load(&["command"]).unwrap().columns[0].values().last().copied();
    (data.contents().unwrap().events.clone(), command.unwrap())
}

fn says(events: &[Event], kind: &str, words: &str) -> bool {
    events.iter().any(|event| event.kind == kind && event.text.contains(words))
}

#[test]
fn the_bench_is_armed_run_and_stopped_and_no_dialog_delays_the_emergency_stop() {
    let Some(display) = Display::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    {
        let window = Window::open(&display, folder.path());
        window.run();
        window.keys("ctrl+shift+d");
        window.is("idle");
        window.run();
        window.open_dialog();
        window.keys("Escape");
        window.is("in fault");
    }
    let window = Window::open(&display, folder.path());
    window.run();
    window.open_dialog();
    // The button at the upper right, which lies below the dialog's backdrop.
    let [x, y] = [SIZE[0] - 70, 18].map(|at| at.to_string());
    display.xdotool(&["mousemove", &x, &y, "click", "1"]);
    window.is("in fault");

    let (events, command) = recorded(&folder.path().join("run-1.mcap"));
    assert!(says(&events, "stop", "stopped by the operator") && !says(&events, "fault", ""), "{events:?}");
    assert_eq!(command, 0.0);
    for name in ["run-2.mcap", "run-3.mcap"] {
        let (events, command) = recorded(&folder.path().join(name));
        assert!(
            says(&events, "stop", "at once") && says(&events, "fault", "emergency stop"),
            "{name} {events:?}"
        );
        assert_eq!(command, 0.0, "{name}");
    }
}

#[test]
fn without_a_display_the_error_names_the_remedy_and_no_line_of_source() {
    for display in [None, Some(":987")] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_socam-host"));
        program
            .arg("dashboard")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .env_remove("DISPLAY");
        program.envs(display.map(|name| ("DISPLAY", name)));
        let ended = program.stdin(Stdio::null()).output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{said}");
        assert!(said.contains("set DISPLAY") && said.contains("--screenshot"), "{said}");
        assert!(!said.contains(".rs") && said.trim_end().lines().count() == 1, "{said}");
    }
}

#[test]
fn a_picture_of_what_is_damaged_does_not_end_as_if_all_were_well() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let socam = |words: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_socam-host"));
        let ended = program.args(words).current_dir(folder.path()).stdin(Stdio::null()).output().unwrap();
        (ended.status.code(), String::from_utf8(ended.stderr).unwrap())
    };
    let draw = |file: &str| socam(&["dashboard", file, "--screenshot", "p.png", "--force"]);
    let (code, said) = socam(&["simulate", "--profile", "steps", "--duration", "20s", "-o", "whole.mcap"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(draw("whole.mcap"), (Some(0), String::new()));
    let bytes = std::fs::read(path("whole.mcap")).unwrap();
    std::fs::write(path("cut.mcap"), &bytes[..bytes.len() * 8 / 10]).unwrap();
    let (code, said) = draw("cut.mcap");
    assert!(code == Some(3) && said.contains("cut.mcap: ") && path("p.png").exists(), "{code:?} {said}");

    let report = path("report");
    std::fs::create_dir(&report).unwrap();
    let diagnosis = include_str!("../../crates/socam-dashboard/tests/panels/sample/diagnosis.json");
    std::fs::write(report.join("diagnosis.json"), diagnosis).unwrap();
    assert_eq!(draw("report").0, Some(0));
    std::fs::write(report.join("model.toml"), "schema = \"socam.model/1\"\nname = 3").unwrap();
    let (code, said) = draw("report");
    assert!(code == Some(1) && said.contains("model.toml"), "{code:?} {said}");
}
