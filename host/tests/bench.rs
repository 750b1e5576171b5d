//! The commands that run a bench, as processes: over TCP, interrupted, killed, refused.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_socam-host"));
    command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn socam(arguments: &[&str]) -> Output {
    command(arguments).output().expect("it starts")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

fn json(output: &Output) -> serde_json::Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON document")
}

/// A virtual board behind a port of its own; gone with its value.
struct Board {
    process: Child,
    device: String,
}

impl Board {
    fn start(more: &[&str]) -> Self {
        let mut process = command(&[&["virtual-board", "--listen", "127.0.0.1:0"], more].concat())
            .spawn()
            .expect("it starts");
        let mut line = String::new();
        let stdout = process.stdout.take().expect("its stdout");
        BufReader::new(stdout).read_line(&mut line).expect("a line");
        let address = line.trim().strip_prefix("listening on ").expect("an address");
        Self { device: format!("tcp:{address}"), process }
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn interrupt(process: &Child) {
    let id = process.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().expect("kill").success());
}

#[test]
fn the_same_bench_gives_the_same_samples_in_process_and_over_tcp() {
    let folder = tempfile::tempdir().expect("a folder");
    let board = Board::start(&["--fast"]);
    let [near, far] = ["near.mcap", "far.mcap"].map(|name| folder.path().join(name));
    let record = |path: &Path, device: &str| {
        let arguments = ["record", "--json", "--rate", "10000", "--profile", "steps", "--duration", "3s"];
        json(&socam(&[&arguments[..], &["-o", text(path), "--device", device]].concat()))
    };
    let (a, b) = (record(&near, "sim"), record(&far, &board.device));
    assert_eq!(a["lost"], 0);
    assert_eq!((&a["samples"], &a["end"]), (&b["samples"], &b["end"]));
    // Noise differs by when the run began; the command does not. Sums are taken chunk by chunk of the file, so
    // that the last digit may differ.
    let means = [&near, &far].map(|path| {
        let info = json(&socam(&["info", "--json", text(path)]));
        info["recordings"][0]["channels"][0]["mean"].as_f64().expect("a mean")
    });
    assert!((means[0] - means[1]).abs() <= 1e-12 * means[0].abs(), "{means:?}");
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_ramps_down_and_a_killed_one_leaves_a_log() {
    let folder = tempfile::tempdir().expect("a folder");
    let board = Board::start(&[]);
    let [stopped, killed] = ["stopped.mcap", "killed.mcap"].map(|name| folder.path().join(name));
    let begin = |path: &Path| {
        let arguments = [
            "record",
            "--json",
            "--profile",
            "steps",
            "--duration",
            "30s",
            "-o",
            text(path),
            "--device",
            &board.device,
        ];
        let process = command(&arguments).spawn().expect("it starts");
        sleep(Duration::from_millis(1800));
        process
    };
    let process = begin(&stopped);
    interrupt(&process);
    let report = json(&process.wait_with_output().expect("it ends"));
    assert_eq!((&report["end"], &report["lost"]), (&"stopped".into(), &0.into()));

    let mut process = begin(&killed);
    process.kill().expect("it can be killed");
    process.wait().expect("it ends");
    let info = socam(&["info", "--json", text(&killed)]);
    assert_eq!(info.status.code(), Some(3));
    let info: serde_json::Value = serde_json::from_slice(&info.stdout).expect("one JSON document");
    let recording = &info["recordings"][0];
    let seconds = recording["duration_s"].as_f64().expect("a duration");
    assert!(seconds > 0.5, "{seconds}");
    assert!(recording["cut"].is_object(), "{recording}");
}

#[test]
fn a_simulation_is_repeatable_and_its_own_model_explains_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let [first, again, table] = ["a.csv", "b.csv", "c.csv"].map(|name| folder.path().join(name));
    for path in [&first, &again, &table] {
        let hidden = "coulomb_friction@load_bearing:torque=0.4";
        let arguments =
            ["simulate", "--profile", "multisine", "--duration", "4s", "--hide", hidden, "-o", text(path)];
        assert!(socam(&arguments).status.success());
    }
    let read = |path: &Path| std::fs::read(path).expect("a file");
    assert!(read(&first) == read(&again));
    let errors = |more: &[&str]| {
        let comparison = json(&socam(&[&["simulate", "--json", "--input", text(&table)], more].concat()));
        let channels = comparison["channels"].as_array().expect("channels").clone();
        let torque = channels.iter().find(|channel| channel["channel"] == "torque_out").expect("torque_out");
        torque["rms"].as_f64().expect("a number")
    };
    let (plain, told) = (errors(&[]), errors(&["--hide", "coulomb_friction@load_bearing:torque=0.4"]));
    assert!(plain > 0.3 && told < 0.05, "{plain} {told}");
}

#[test]
fn what_cannot_be_run_is_refused_in_words_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    let (output, nowhere) = (text(&path), folder.path().join("none/run.mcap"));
    let sim = ["--device", "sim"];
    for (arguments, code, expected) in [
        (vec!["record", "-o", output, "--profile", "wiggle", sim[0], sim[1]], 1, "built in are multisine"),
        (
            vec!["record", "-o", output, "--profile", "steps", "--duration", "-3s", sim[0], sim[1]],
            2,
            "greater than 0",
        ),
        (
            vec!["record", "-o", output, "--profile", "steps", "--model", "none.toml", sim[0], sim[1]],
            2,
            "none.toml",
        ),
        (
            vec!["record", "-o", text(&nowhere), "--profile", "steps", sim[0], sim[1]],
            1,
            "folder does not exist",
        ),
        (
            vec!["record", "-o", output, "--profile", "steps", "--device", "tcp:127.0.0.1:1"],
            1,
            "nothing listens",
        ),
        (
            vec!["record", "-o", output, "--profile", "steps", "--device", "serial:/none"],
            1,
            "serial line /none",
        ),
        (vec!["simulate", "-o", output, "--profile", "steps", "--hide", "rust@load"], 2, "no effect `rust`"),
        (vec!["simulate", "-o", output, "--profile", "steps", "--set", "k9=1"], 2, "no parameter"),
        (vec!["simulate", "--input", "none.csv"], 1, "no such file"),
    ] {
        let result = socam(&arguments);
        let stderr = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(code), "{arguments:?}: {stderr}");
        assert!(stderr.contains(expected) && result.stdout.is_empty(), "{arguments:?}: {stderr}");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0, "{arguments:?}");
    }
}

#[test]
fn a_peer_of_another_protocol_is_told_apart_from_silence() {
    use std::io::Write;
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let device = format!("tcp:{}", listener.local_addr().expect("an address"));
    let peer = std::thread::spawn(move || {
        for words in ["HTTP/1.1 400 Bad Request\r\n", ""] {
            let (mut host, _) = listener.accept().expect("a host");
            host.write_all(words.as_bytes()).expect("words");
            sleep(Duration::from_millis(3500));
        }
    });
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    for expected in ["not in this protocol", "says nothing"] {
        let result = socam(&["record", "-o", text(&path), "--profile", "steps", "--device", &device]);
        let stderr = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(1));
        assert!(stderr.contains(expected), "{stderr}");
        sleep(Duration::from_millis(600));
    }
    peer.join().expect("a peer");
}

#[test]
fn a_board_serves_one_host_that_knows_its_token_and_says_something() {
    use std::io::Write;
    let wide = socam(&["virtual-board", "--listen", "0.0.0.0:0"]);
    assert_eq!(wide.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wide.stderr).contains("--token-file"));

    let folder = tempfile::tempdir().expect("a folder");
    let [path, secret] = ["run.mcap", "secret.txt"].map(|name| folder.path().join(name));
    std::fs::write(&secret, "correct-horse\n").expect("a file");
    let board = Board::start(&["--token-file", text(&secret), "--fast"]);
    let record = |more: &[&str]| {
        let arguments = ["record", "-o", text(&path), "--profile", "steps", "--duration", "3s", "--device"];
        socam(&[&arguments[..], &[&board.device], more].concat())
    };
    let refused = |more: &[&str], why: &str| {
        let result = record(more);
        let stderr = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(1), "{stderr}");
        assert!(stderr.contains("refuses") && stderr.contains(why), "{stderr}");
    };
    refused(&[], "asks for its token");
    refused(&["--token", "incorrect-horse"], "asks for its token");
    let address = board.device.strip_prefix("tcp:").expect("an address");
    let mut idle = std::net::TcpStream::connect(address).expect("a connection");
    idle.write_all(b"socam-token correct-horse\nand nothing that is a frame").expect("a line");
    sleep(Duration::from_millis(300));
    let known = ["--token-file", text(&secret)];
    refused(&known, "another host");
    // The silent host is dropped after five seconds.
    sleep(Duration::from_millis(5500));
    let result = record(&known);
    assert!(result.status.success(), "{}", String::from_utf8_lossy(&result.stderr));
}

#[test]
fn the_first_interrupt_ends_a_simulation_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    let arguments = ["simulate", "--profile", "prbs", "--duration", "20h", "-o", text(&path)];
    let process = command(&arguments).spawn().expect("it starts");
    let files = || std::fs::read_dir(folder.path()).expect("a folder").count();
    while files() == 0 {
        sleep(Duration::from_millis(20));
    }
    sleep(Duration::from_millis(300));
    interrupt(&process);
    let output = process.wait_with_output().expect("its end");
    assert_eq!(
        (output.status.code(), files()),
        (Some(130), 0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}
