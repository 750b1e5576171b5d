//! The gearmotor board's image on an emulated RP2040, at a simulated gearmotor: first run, recording, fit, and what stops it.

use std::path::Path;

use serde_json::{Value, json};
use socam_tests::emulator::{Emulator, gearmotor};
use socam_tests::{Ran, firmware, run};

/// Into the run.
const AFTER_S: f64 = 0.4;

const PROFILE: &str = "
schema = 'socam.profile/1'
command = 'voltage'
shape = 'constant'
level_V = 6
limit_V = 6
slew_V_s = 100
duration_s = 1
";

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_owned()
}

fn record(board: &Emulator, log: &str, profile: &str, more: &[&str]) -> Ran {
    let arguments =
        ["record", "-o", log, "--force", "--device", &board.device, "--profile", profile, "--json"];
    run(arguments.iter().chain(more))
}

fn measured(board: &mut Emulator) -> Value {
    board.ask(&json!({ "ask": "measured", "stepUs": 250 }))
}

#[test]
fn a_gearmotor_is_taken_from_its_first_run_to_a_fit() {
    let Some(mut board) = Emulator::start_gearmotor(gearmotor(&[], 3)) else { return };
    let folder = tempfile::tempdir().unwrap();
    let (mine, log) = (path(folder.path(), "mine.toml"), path(folder.path(), "run.mcap"));
    let said = run(["first-run", "--device", &board.device, "-o", &mine]).done();
    println!("measured: first run on the emulated board: {said}");
    assert!(said.contains("1024 counts per turn by its index, counts with the voltage"), "{said}");
    assert!(said.contains("2400 counts per turn, counts with the voltage"), "{said}");
    // A current that is late by a conversion, 0.25 ms, adds 2.2 ohm times that.
    let inductance = said.split_once("about ").and_then(|(_, rest)| rest.split(' ').next()?.parse().ok());
    assert!(inductance.is_some_and(|mh: f64| (mh - 1.5).abs() < 0.2), "{said}");
    board.ask(&json!({ "ask": "reset-measured" }));
    let ran = record(&board, &log, "gearmotor", &["--duration", "3s", "--calibration", &mine]).json();
    assert_eq!((&ran["end"], &ran["lost"]), (&"finished".into(), &0.into()), "{ran}");
    let sampling = measured(&mut board);
    println!("measured: gearmotor at 1 kHz: {sampling}");
    let number = |name: &str| sampling[name].as_f64().unwrap();
    assert!(number("conversions") > 10_000.0, "{sampling}");
    assert!(number("worstCycles") < firmware::limit("gearmotor_interrupt_cycles_1_khz") as f64, "{sampling}");
    assert!(number("spreadNs") < firmware::limit("instant_spread_ns") as f64, "{sampling}");
    assert!(number("stackBytes") < firmware::limit("stack_bytes") as f64, "{sampling}");
    let fitted = run(["identify", &log, "--model", "gearmotor", "--json"]).json();
    // Within this share of the truth.
    for (name, truth, share) in [("R", 2.2, 0.05), ("kt", 0.011, 0.02), ("ratio", 30.0, 0.001)] {
        let entry =
            fitted["parameters"].as_array().unwrap().iter().find(|entry| entry["name"] == name).unwrap();
        println!("measured: {name}: {} in {}, truth {truth}", entry["value"], entry["ci95"]);
        assert!((entry["value"].as_f64().unwrap() / truth - 1.0).abs() < share, "{entry}");
    }
}

/// Each with the time within which the bridge must be off, its message, and what repairs it.
const FAILURES: [(&str, f64, &str, &str); 7] = [
    ("open-stop", 1e-6, "emergency stop", "close-stop"),
    ("hang", 0.002, "", ""),
    ("supply=gone", 0.004, "the motor's supply is low or gone", "supply=well"),
    ("reading=0@3.25", 0.004, "over-current: motor_current", "reading=0"),
    ("encoder=silent", 0.2, "but the motor turns at about", "encoder=well"),
    ("encoder=swapped", 0.2, "swap the encoder's wires A and B", "encoder=well"),
    ("pull-cable", 0.002, "", "plug-cable"),
];

#[test]
fn each_failure_lets_the_motor_coast_in_time() {
    let Some(mut board) = Emulator::start_gearmotor(gearmotor(&[], 3)) else { return };
    let folder = tempfile::tempdir().unwrap();
    let (log, profile) = (path(folder.path(), "run.mcap"), path(folder.path(), "steady.toml"));
    std::fs::write(&profile, PROFILE).unwrap();
    for (what, within_s, says, mend) in FAILURES {
        board.inject(what, Some(AFTER_S));
        let ran = record(&board, &log, &profile, &[]);
        board.run_for(0.05);
        let events = board.log();
        let at = |kind: &str, from_s: f64| {
            events.iter().find(|event| event.at_s >= from_s && event.what == kind && event.value != true)
        };
        let injected = events.iter().rfind(|event| event.what == "injected");
        let injected = injected.unwrap_or_else(|| panic!("{what}: {ran:?}")).at_s;
        let off = at("enable", injected).unwrap_or_else(|| panic!("{what}: {ran:?}")).at_s;
        println!("measured: {what}: bridge off after {:.3} ms", (off - injected) * 1e3);
        assert!(off - injected <= within_s, "{what}: {events:?}");
        assert_eq!(ran.code, Some(1), "{what}: {ran:?}");
        assert!(format!("{ran:?}").contains(says), "{what}: {ran:?}");
        if !mend.is_empty() {
            board.inject(mend, None);
            board.run_for(0.5);
        }
    }
    assert_eq!(record(&board, &log, &profile, &[]).code, Some(0));
}
