//! `record` as a process, against the virtual board: what is recorded is identified, what dies leaves a readable log, and a peer
//! that is no board is named as such.

mod foreign;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use socam_tests::{Ran, path, run, socam_host};

fn record(device: &str, log: &str, more: &[&str]) -> Ran {
    let arguments = ["record", "-o", log, "--device", device, "--profile", "multisine"];
    run(arguments.iter().chain(more))
}

/// A process that does not outlive its test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A virtual board that listens, and the name of its device.
fn virtual_board(more: &[&str]) -> (Running, String) {
    let mut command = socam_host();
    command.args(["virtual-board", "--listen", "127.0.0.1:0"]).args(more);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut board = Running(child);
    let mut line = String::new();
    BufReader::new(board.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let address = line.trim().strip_prefix("listening on ").unwrap_or_else(|| panic!("{line}"));
    (board, format!("tcp:{address}"))
}

fn info(log: &str) -> Value {
    let ran = run(["info", "--json", log]);
    let document = ran.document();
    let recording = document["recordings"][0].clone();
    let is_lossy = !recording["cut"].is_null() || recording["lost_samples"] != 0;
    assert_eq!(ran.code, Some(if is_lossy { 3 } else { 0 }), "{ran:?}");
    recording
}

#[test]
fn what_is_recorded_is_identified() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let more = ["--duration", "10s", "--set", "k4=120", "--set", "c5=0.04"];
    let recorded = record("sim", &log, &[&more[..], &["--json"]].concat()).json();
    assert_eq!(recorded["samples"], 10_000);
    assert_eq!(recorded["lost"], 0);
    let result = run(["identify", &log, "--json"]).json();
    let value = |list: &str, name: &str| {
        let found = result[list].as_array().unwrap().iter().find(|entry| entry["name"] == name);
        found
            .and_then(|entry| entry["value"].as_f64())
            .unwrap_or_else(|| panic!("no {name}: {}", result[list]))
    };
    // Converters, ramps and noise included, the bench's own values come back within one per cent.
    for (list, name, truth) in [
        ("parameters", "k4", 120.0),
        ("parameters", "c5", 0.04),
        ("combinations", "k_series_12", 180.0 / std::f64::consts::PI / (1.0 / 1.24 + 1.0 / 0.95)),
    ] {
        let value = value(list, name);
        assert!((value / truth - 1.0).abs() < 0.01, "{name} is {value}, should be {truth}");
    }
}

#[test]
fn the_same_seed_gives_the_same_samples_in_process_and_over_tcp() {
    let folder = tempfile::tempdir().unwrap();
    let (_board, device) = virtual_board(&["--fast", "--seed", "7"]);
    let (near, far) = (path(&folder, "near.mcap"), path(&folder, "far.mcap"));
    let _ = record("sim", &near, &["--duration", "3s", "--seed", "7"]).done();
    let _ = record(&device, &far, &["--duration", "3s"]).done();
    let (near, far) = (info(&near), info(&far));
    assert_eq!(near["rows"], 3000);
    assert_eq!(far["rows"], near["rows"]);
    // The benches have run for different times before the start, so their noise differs, and nothing else.
    for (near, far) in near["channels"].as_array().unwrap().iter().zip(far["channels"].as_array().unwrap()) {
        assert_eq!(near["name"], far["name"]);
        let (near, far) = (near["std"].as_f64().unwrap(), far["std"].as_f64().unwrap());
        assert!((near / far - 1.0).abs() < 0.01, "{near} against {far}");
    }
}

/// Killed in real time, a recorder leaves all but the last second.
#[test]
fn a_killed_recorder_leaves_all_but_the_last_second() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let mut command = socam_host();
    command.args(["record", "-o", &log, "--device", "sim", "--profile", "multisine", "--realtime"]);
    let started = Instant::now();
    let mut recorder = Running(
        command.args(["--duration", "20s"]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap(),
    );
    while !Path::new(&log).exists() && started.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let sampling = Instant::now();
    std::thread::sleep(Duration::from_millis(3500));
    recorder.0.kill().unwrap();
    recorder.0.wait().unwrap();
    let recorded_s = sampling.elapsed().as_secs_f64();

    let info = info(&log);
    let end_s = info["end_s"].as_f64().unwrap();
    // The file stands before the board starts, and a loaded machine is late to kill: half a second for both.
    assert!(end_s > recorded_s - 1.5, "only {end_s} s of {recorded_s} s are left");
    assert!(end_s < recorded_s + 0.5);
    let cut =
        info["cut"]["missing"].as_str().unwrap_or_else(|| panic!("nothing says that it was cut: {info}"));
    assert!(cut.contains("of the planned 20 s"), "{cut}");
    assert_eq!(info["gaps"], serde_json::json!([]));
    assert_eq!(folder.path().read_dir().unwrap().count(), 1, "nothing but the log is left");
}

#[test]
fn a_cut_log_is_exported_as_far_as_it_goes_and_the_exit_code_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let (log, table) = (path(&folder, "run.mcap"), path(&folder, "run.csv"));
    let _ = record("sim", &log, &["--duration", "30s"]).done();
    let bytes = std::fs::read(&log).unwrap();
    std::fs::write(&log, &bytes[..bytes.len() / 2]).unwrap();
    let ran = run(["export", &log, "-o", &table]);
    assert_eq!(ran.code, Some(3), "{ran:?}");
    assert!(ran.stderr.contains("warning") && ran.stderr.contains("cut"), "{ran:?}");
    let rows = std::fs::read_to_string(&table).unwrap().lines().count() as u64 - 1;
    assert_eq!(info(&log)["rows"].as_u64(), Some(rows));
    assert!((5_000..25_000).contains(&rows), "{rows}");
}

#[test]
fn a_recording_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let _ = record("sim", &log, &["--duration", "2.5s"]).done();
    let before = std::fs::read(&log).unwrap();
    let ran = record("sim", &log, &["--duration", "2.5s"]);
    assert!(ran.refusal(1).contains("exists already"), "{ran:?}");
    assert_eq!(std::fs::read(&log).unwrap(), before);
}

#[test]
fn a_bad_order_is_refused_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let absent = path(&folder, "absent/run.mcap");
    let refused = |arguments: &[&str], code, mentions: &[&str]| {
        let ran = run(arguments);
        let sentence = ran.refusal(code);
        for mention in mentions {
            assert!(sentence.contains(mention), "{arguments:?} does not mention `{mention}`: {sentence}");
        }
        assert_eq!(folder.path().read_dir().unwrap().count(), 0, "{arguments:?} left something behind");
    };
    let sim = ["record", "--device", "sim", "-o", &log, "--profile"];
    let with = |more: &[&'static str]| [&sim[..], more].concat();
    refused(&with(&["wobble"]), 1, &["wobble", "multisine"]);
    refused(&with(&["multisine", "--duration", "1s"]), 2, &["--duration", "too short"]);
    refused(&with(&["multisine", "--duration", "soon"]), 2, &["soon", "expected"]);
    refused(&with(&["multisine", "--rate", "0"]), 2, &["--rate", "1 to 20000 Hz"]);
    refused(&with(&["multisine", "--set", "k9=1"]), 2, &["k9", "k1, k2, k3"]);
    refused(&with(&["multisine", "--hide", "gremlins@mesh:count=3"]), 2, &["gremlins", "coulomb_friction"]);
    refused(&with(&["multisine", "--model", "speed-o-cog"]), 2, &["speed-o-cog", "speed-o-cam"]);
    let sim_to = |log| ["record", "--device", "sim", "-o", log, "--profile", "multisine"];
    refused(&sim_to(&absent), 1, &["absent/run.mcap", "folder does not exist"]);
    refused(&sim_to("run.xls"), 2, &["run.xls", ".mcap"]);
    let on = |device| ["record", "--device", device, "-o", &log, "--profile", "multisine"];
    refused(&on("usb"), 2, &["usb", "serial:PATH"]);
    refused(&on("tcp:127.0.0.1"), 2, &["tcp:127.0.0.1", "HOST:PORT"]);
    refused(&on("serial:/dev/no-such-line"), 1, &["/dev/no-such-line"]);
}

/// A peer that accepts and then says `talk`, over and over.
fn peer(talk: &'static [u8]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut heard = [0; 256];
        // Until the host hangs up.
        while stream.read(&mut heard).is_ok_and(|count| count > 0) && stream.write_all(talk).is_ok() {}
    });
    format!("tcp:{address}")
}

#[test]
fn a_peer_that_is_no_board_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    for (device, why) in [
        (peer(b""), "says nothing"),
        (peer(b"HTTP/1.1 400 Bad Request\r\n\r\n"), "not in this protocol"),
        (peer(&[0xff, 0, 0x17, 0, 0, 3]), "not in this protocol"),
        (format!("tcp:{free}"), "nothing listens there"),
    ] {
        let ran = record(&device, &log, &[]);
        let sentence = ran.refusal(1);
        assert!(sentence.contains(&device) && sentence.contains(why), "{sentence}");
        assert_eq!(folder.path().read_dir().unwrap().count(), 0, "{device} left something behind");
    }
}

#[test]
fn a_board_that_dies_while_recording_fails_and_leaves_what_was_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let (mut board, device) = virtual_board(&[]);
    let recorder = std::thread::scope(|scope| {
        let recorder = scope.spawn(|| record(&device, &log, &[]));
        while !Path::new(&log).exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(2000));
        board.0.kill().unwrap();
        recorder.join().unwrap()
    });
    assert_eq!(recorder.code, Some(1), "{recorder:?}");
    assert!(recorder.stderr.contains(&log) && recorder.stderr.contains("link"), "{recorder:?}");
    assert!(info(&log)["end_s"].as_f64().unwrap() > 1.0);
}

#[test]
#[cfg(target_os = "linux")]
fn a_disk_that_fills_up_is_said_and_what_was_recorded_stays() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    // With the signal ignored, passing the limit (8 MiB) is an error like any other.
    let script = "trap '' XFSZ; ulimit -f 16384; exec \"$@\"";
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", script, "sh"]).arg(socam_tests::program());
    shell.args(["record", "-o", &log, "--device", "sim", "--profile", "multisine", "--duration", "600s"]);
    let ran: Ran = shell.output().unwrap().into();
    let sentence = ran.refusal(1);
    let rows = info(&log)["rows"].as_u64().unwrap();
    assert!(rows > 1000);
    assert!(
        sentence.contains(&log) && sentence.contains(&format!("ends after {rows} samples")),
        "{sentence}"
    );
}
