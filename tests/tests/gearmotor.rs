//! A gearmotor on its board: first run, record, identify, and what stops it.

use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};

use socam_tests::{path, run, socam_host};

/// Killed when the test ends.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A virtual gearmotor board that is wired as a calibration says, and the name of its device.
fn wired(calibration: &str) -> (Running, String) {
    let arguments = ["virtual-board", "--listen", "127.0.0.1:0", "--fast", "--model", "gearmotor"];
    let mut command = socam_host();
    command.args(arguments).args(["--calibration", calibration]);
    let mut board = Running(command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap());
    let mut line = String::new();
    BufReader::new(board.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let address = line.trim().strip_prefix("listening on ").unwrap_or_else(|| panic!("{line}"));
    (board, format!("tcp:{address}"))
}

/// The calibration of the default gearmotor with other encoders: counts per turn of the motor's and the output's.
fn calibration(folder: &tempfile::TempDir, motor: &str, output: &str) -> String {
    let text = run(["template", "calibration", "gearmotor"]).done();
    let changed = text
        .replace("counts_per_turn = 1024", &format!("counts_per_turn = {motor}"))
        .replace("counts_per_turn = 2400", &format!("counts_per_turn = {output}"));
    assert_ne!(changed, text);
    let file = path(folder, "wiring.toml");
    std::fs::write(&file, changed).unwrap();
    file
}

#[test]
fn a_first_run_finds_wrong_wires_and_the_run_after_it_is_right() {
    let folder = tempfile::tempdir().unwrap();
    // The motor's encoder has 500 counts, not 1024, and its wires are swapped.
    let wiring = calibration(&folder, "-500", "2400");
    let (mine, log) = (path(&folder, "mine.toml"), path(&folder, "run.mcap"));
    let record = |more: &[&str]| {
        let (_board, device) = wired(&wiring);
        let arguments =
            ["record", "-o", &log, "--device", &device, "--profile", "gearmotor", "--duration", "6s"];
        run(arguments.iter().chain(more))
    };

    // With the default calibration the board finds the swapped wires itself, and stops.
    let stopped = record(&[]);
    assert_eq!(stopped.code, Some(1), "{stopped:?}");
    assert!(stopped.stderr.contains("swap the encoder's wires A and B"), "{stopped:?}");

    let (_board, device) = wired(&wiring);
    let said = run(["first-run", "--device", &device, "-o", &mine]).done();
    assert!(said.contains("500 counts per turn by its index, counts against the voltage"), "{said}");
    assert!(said.contains("2400 counts per turn, counts with the voltage"), "{said}");
    let number = |what: &str| {
        let line = said.lines().find(|line| line.starts_with(what)).unwrap_or_else(|| panic!("{said}"));
        let words: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        words[0]
    };
    // Of the virtual gearmotor: 2.2 ohm, 11 mV s/rad and a gear of 30.
    for (what, truth, tolerance) in
        [("resistance", 2.2, 0.02), ("back-EMF", 11.0, 0.05), ("gear", 30.0, 0.02)]
    {
        assert!((number(what) - truth).abs() < tolerance, "{what}: {said}");
    }
    let again = run(["first-run", "--device", &device, "-o", &mine]);
    assert_eq!(again.code, Some(1));
    assert!(again.stderr.contains("exists already"), "{again:?}");

    let recorded = record(&["--calibration", &mine, "--force", "--json"]).json();
    assert_eq!((&recorded["end"], &recorded["lost"]), (&"finished".into(), &0.into()), "{recorded}");
}

#[cfg(feature = "full")]
#[test]
fn winding_gear_friction_and_shaft_are_in_their_intervals() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let arguments =
        ["record", "-o", &log, "--device", "sim", "--model", "gearmotor", "--profile", "gearmotor"];
    let _ = run(arguments.iter().chain(&["--duration", "6s"])).done();
    let result = run(["identify", &log, "--model", "gearmotor", "--json"]).json();
    for (name, truth) in [
        ("R", 2.2),
        ("kt", 0.011),
        ("J_motor", 2e-6),
        ("d_motor", 2e-6),
        ("friction_motor", 1.5e-3),
        ("ratio", 30.0),
        ("k_shaft", 40.0),
        ("c_shaft", 0.03),
    ] {
        let (low, high) = interval(&result, name);
        println!("measured: {name}: {truth} in [{low}, {high}]");
        assert!(low <= truth && truth <= high, "{name}: {truth} is not in [{low}, {high}]");
    }
}

#[cfg(feature = "full")]
fn interval(result: &serde_json::Value, name: &str) -> (f64, f64) {
    let entry = result["parameters"].as_array().unwrap().iter().find(|entry| entry["name"] == name).unwrap();
    let end = |index: usize| entry["ci95"][index].as_f64().unwrap_or_else(|| panic!("{entry}"));
    (end(0), end(1))
}

#[test]
fn a_board_is_not_read_with_the_calibration_of_another_kind() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let file = calibration(&folder, "500", "2400");
    let arguments = ["record", "-o", &log, "--device", "sim", "--profile", "steps", "--calibration", &file];
    let ran = run(arguments);
    assert_eq!(ran.code, Some(1));
    assert!(ran.stderr.contains("a gearmotor board drives a winding"), "{ran:?}");
}
