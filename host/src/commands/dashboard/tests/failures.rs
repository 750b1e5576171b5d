//! Devices, links, folders and disks that fail.

use std::net::{Shutdown, TcpListener, TcpStream};
use std::path::Path;
use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable;
use socam_core::State;
use socam_recording::Dataset;

use super::{click, connected, running, state, until, window};

#[test]
fn a_device_that_is_not_there_and_a_folder_that_is_not_there_are_said_in_place() {
    let folder = tempfile::tempdir().unwrap();
    let mut lost = window("tcp:127.0.0.1:1", folder.path(), 1000.0);
    click(&mut lost, "Connect");
    until(&mut lost, "a sentence", |window| {
        window.query_by_label_contains("nothing listens there").is_some()
    });
    lost.get_by_label("Connect");
    let mut window = connected("sim", &folder.path().join("nowhere"), 1000.0);
    click(&mut window, "Arm");
    until(&mut window, "armed", |window| state(window) == Some(State::Armed));
    click(&mut window, "Run");
    until(&mut window, "a sentence", |window| window.state().workspace.bench.ended().is_some());
    let (_, text, well) = window.state().workspace.bench.ended().unwrap();
    assert!(!well && text.contains("nowhere"), "{text}");
    until(&mut window, "rest", |window| state(window) == Some(State::Idle));
    click(&mut window, "Disconnect");
    until(&mut window, "an end", |window| !window.state().workspace.bench.is_connected());
}

#[test]
fn a_link_that_nobody_answers_is_given_up_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let silent = TcpListener::bind("127.0.0.1:0").unwrap();
    let mut window = window(&format!("tcp:{}", silent.local_addr().unwrap()), folder.path(), 1000.0);
    click(&mut window, "Connect");
    window.get_by_label("asking the device who it is, or listening to it");
    click(&mut window, "Cancel");
    window.get_by_label("Connect");
    window.get_by_label("no board");
    // Later events of the cancelled connection do not disturb the next link.
    click(&mut window, "Connect");
    until(&mut window, "a sentence", |window| window.query_by_label_contains("says nothing").is_some());
}

/// A board behind TCP, and a line to it that can be cut. Returns the address, and a function that cuts the line.
fn board_on_a_line() -> (String, impl FnOnce()) {
    #[derive(clap::Parser)]
    struct Server {
        #[command(flatten)]
        args: crate::commands::virtual_board::Args,
    }
    let [board, line] = [(); 2].map(|()| TcpListener::bind("127.0.0.1:0").unwrap());
    let [board_at, line_at] = [&board, &line].map(|listener| listener.local_addr().unwrap().to_string());
    drop(board);
    let server: Server = clap::Parser::parse_from(["board", "--once", "--listen", &board_at]);
    std::thread::spawn(move || crate::commands::virtual_board::run(server.args));
    let (ends, cut) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        let window = line.accept().unwrap().0;
        let begin = Instant::now();
        let board = loop {
            match TcpStream::connect(&board_at) {
                Ok(board) => break board,
                Err(error) => assert!(begin.elapsed() < Duration::from_secs(30), "{error}"),
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        let copy = |mut from: TcpStream, mut to: TcpStream| {
            std::thread::spawn(move || std::io::copy(&mut from, &mut to));
        };
        copy(window.try_clone().unwrap(), board.try_clone().unwrap());
        copy(board.try_clone().unwrap(), window.try_clone().unwrap());
        ends.send([window, board]).unwrap();
    });
    (format!("tcp:{line_at}"), move || {
        for end in cut.recv().unwrap() {
            end.shutdown(Shutdown::Both).unwrap();
        }
    })
}

#[test]
fn a_board_that_vanishes_in_mid_run_is_said_in_place_and_what_was_recorded_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let (device, cut) = board_on_a_line();
    let mut window = connected(&device, folder.path(), 1000.0);
    running(&mut window);
    let before = window.state().workspace.bench.buffer().rows();
    until(&mut window, "a second", |window| window.state().workspace.bench.buffer().rows() > before + 1000);
    cut();
    until(&mut window, "the end", |window| !window.state().workspace.bench.is_connected());
    let (path, text, well) = window.state().workspace.bench.ended().unwrap();
    assert!(!well && text.contains("run-1.mcap") && text.contains("samples over"), "{text}");
    let data = Dataset::open(&path.display().to_string()).unwrap();
    assert!(data.rows() > 500 && data.cut().is_none(), "{} {:?}", data.rows(), data.cut());
    window.run_steps(2);
    assert!(
        window.query_all_by_label_contains("closed the link").count() > 0,
        "{:?}",
        window.state().workspace.bench
    );
    window.get_by_label("Connect");
    window.get_by_label("no board");
    click(&mut window, "Look at the recording");
    until(&mut window, "the recording", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label("Chart motor_speed, rad/s");
}

/// Names a folder on a disk so small that a recording fills it.
const SMALL_DISK: &str = "SOCAM_TEST_SMALL_DISK";

#[test]
fn a_disk_that_fills_up_stops_the_bench_and_keeps_what_it_has() {
    if let Some(folder) = std::env::var_os(SMALL_DISK) {
        return fills_up(Path::new(&folder));
    }
    // Such a disk needs its own name space, in which this test runs again.
    let folder = tempfile::tempdir().unwrap();
    let small = |command: &str| {
        let mount = format!("mount -t tmpfs -o size=160k socam \"${SMALL_DISK}\" && {command}");
        let mut inside = std::process::Command::new("unshare");
        inside.args(["--map-root-user", "--mount", "sh", "-c", &mount]).env(SMALL_DISK, folder.path());
        inside.output()
    };
    if !small("true").is_ok_and(|tried| tried.status.success()) {
        eprintln!(
            "skipped: this system lets nobody mount a small disk, on which a recording is to run out of room"
        );
        return;
    }
    let own = std::env::current_exe().unwrap();
    let name = "a_disk_that_fills_up_stops_the_bench_and_keeps_what_it_has";
    let tried = small(&format!("exec '{}' {name} --nocapture", own.display())).unwrap();
    let said = [tried.stdout, tried.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(tried.status.success() && said[0].contains("1 passed"), "{}{}", said[0], said[1]);
}

fn fills_up(folder: &Path) {
    // At 5 kHz the first second alone is as large as the disk, and a log without a whole chunk is not kept.
    let mut window = connected("sim", folder, 2000.0);
    running(&mut window);
    until(&mut window, "the end", |window| window.state().workspace.bench.ended().is_some());
    let (path, text, well) = window.state().workspace.bench.ended().unwrap();
    assert!(!well && text.contains("disk is full") && text.contains("run-1.mcap"), "{text}");
    let data = Dataset::open(&path.display().to_string()).unwrap();
    assert!(data.rows() > 1000 && data.lost_samples() == 0, "{}", data.rows());
    // A copy does not fit either, and no part of it remains.
    let name = path.display().to_string();
    window.state_mut().open([name]);
    until(&mut window, "the recording", |window| !window.state().is_busy());
    window.state_mut().layout.folder = folder.into();
    click(&mut window, "File");
    click(&mut window, "Save recording as .csv or .m...");
    click(&mut window, "Save");
    until(&mut window, "a sentence", |window| window.state().problems().count() > 0);
    let problems: Vec<&str> = window.state().problems().collect();
    assert!(problems[0].contains("run-1.csv") && problems[0].contains("space"), "{problems:?}");
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), 1);
    click(&mut window, "Live");
    // The bench must not continue unobserved; the window continues.
    until(&mut window, "rest", |window| state(window) == Some(State::Idle));
    let shown = window.state().workspace.bench.buffer().rows();
    until(&mut window, "samples", |window| window.state().workspace.bench.buffer().rows() > shown);
}
