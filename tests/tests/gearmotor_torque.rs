//! A torque transducer on the emulated gearmotor's board: what it records, what a fit makes of it, and what is said when it fails.

use serde_json::json;
use socam_recording::{Calibration, Dataset};
use socam_sim::Setup;
use socam_tests::emulator::{Emulator, gearmotor};
use socam_tests::{Ran, firmware, path, run};

/// Friction at the load's bearing, N m: what the transducer measures of a shaft that turns steadily.
const FRICTION_NM: f64 = 0.05;

/// Conversions per second.
const CONVERSIONS_HZ: f64 = 80.0;

const PROFILE: &str = "
schema = 'socam.profile/1'
command = 'voltage'
shape = 'constant'
level_V = 6
limit_V = 6
slew_V_s = 100
duration_s = 3
";

/// Slow, and in one direction: what a mean over 50 ms follows.
const SLOW: &str = "
schema = 'socam.profile/1'
command = 'voltage'
shape = 'multisine'
offset_V = 6
amplitude_V = 2
lines = 'odd'
from_Hz = 0.2
to_Hz = 2
period_s = 5
seed = 1
ramp_s = 0.5
limit_V = 9
slew_V_s = 4000
duration_s = 5
";

/// What the embedded model lacks: the friction, and the transducer with the filter of its converter.
const MODEL: &str = r#"
[channels.output_torque]
role = "output"
quantity = "torque"
at = "shaft"

[[effects]]
effect = "coulomb_friction"
at = "load_bearing"
parameters = { torque = "friction_load" }
[[effects]]
effect = "sensor_delay"
at = "output_torque"
parameters = { delay = "transducer_delay" }
[[effects]]
effect = "sensor_lag"
at = "output_torque"
parameters = { time_constant = "transducer_lag" }
"#;

const PARAMETERS: &str = r#"[parameters]
friction_load = { value = 0.02, unit = "N m", bounds = [0, 1], source = "to be found" }
transducer_delay = { value = 10.6, unit = "ms", fixed = true, source = "with the lag: delay and width of a mean over 50 ms" }
transducer_lag = { value = 14.4, unit = "ms", fixed = true, source = "50 ms by the root of 12" }
"#;

struct Bench {
    board: Emulator,
    folder: tempfile::TempDir,
    calibration: String,
}

fn bench() -> Option<Bench> {
    let text = run(["template", "calibration", "gearmotor-torque"]).done();
    let calibration = Calibration::parse(&text).unwrap();
    let hidden = format!("coulomb_friction@load_bearing:torque={FRICTION_NM}");
    let board = Emulator::start_gearmotor(Setup { calibration, ..gearmotor(&[&hidden], 3) })?;
    let folder = tempfile::tempdir().unwrap();
    let file = path(&folder, "torque.toml");
    std::fs::write(&file, text).unwrap();
    std::fs::write(path(&folder, "steady.toml"), PROFILE).unwrap();
    Some(Bench { board, folder, calibration: file })
}

impl Bench {
    fn record(&self, log: &str, profile: &str, more: &[&str]) -> Ran {
        let arguments = ["record", "-o", log, "--force", "--device", &self.board.device, "--json"];
        let with = ["--calibration", &self.calibration, "--profile", profile];
        run(arguments.iter().chain(&with).chain(more))
    }
}

/// Times and values of the conversions in a recording, s and N m.
fn conversions(log: &str) -> Vec<(f64, f64)> {
    let data = Dataset::open(log).unwrap().load(&["output_torque_Nm"]).unwrap();
    let values = data.columns[0].values().iter().enumerate();
    values.filter(|(_, value)| !value.is_nan()).map(|(row, value)| (row as f64 * 1e-3, *value)).collect()
}

#[test]
fn a_steady_torque_is_measured() {
    let Some(mut bench) = bench() else { return };
    let log = path(&bench.folder, "steady.mcap");
    let profile = path(&bench.folder, "steady.toml");
    bench.board.ask(&json!({ "ask": "reset-measured" }));
    let ran = bench.record(&log, &profile, &[]).json();
    assert_eq!((&ran["end"], &ran["lost"]), (&"finished".into(), &0.into()), "{ran}");
    let sampling = bench.board.ask(&json!({ "ask": "measured", "stepUs": 250 }));
    println!("measured: gearmotor with a transducer at 1 kHz: {sampling}");
    let worst = sampling["worstCycles"].as_f64().unwrap();
    assert!(worst < firmware::limit("gearmotor_interrupt_cycles_1_khz") as f64, "{sampling}");

    // A conversion is in one row, and rows between have none.
    let all = conversions(&log);
    assert!(all.windows(2).all(|pair| (0.0115..0.0135).contains(&(pair[1].0 - pair[0].0))), "{all:?}");
    let steady: Vec<f64> =
        all.iter().filter(|(at_s, _)| (1.0..2.8).contains(at_s)).map(|(_, nm)| *nm).collect();
    let count = steady.len() as f64;
    assert!((count - 1.8 * CONVERSIONS_HZ).abs() < 2.0, "{count} conversions");
    let mean = steady.iter().sum::<f64>() / count;
    let std = (steady.iter().map(|nm| (nm - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    let half = 1.96 * std / count.sqrt();
    println!("measured: torque {mean:.7} +- {half:.7} N m of {count} conversions, truth {FRICTION_NM}");
    assert!((mean - FRICTION_NM).abs() < half.max(1e-5) * 1.5 && half < 1e-4, "{mean} +- {half}");
}

#[test]
fn a_fit_with_a_torque_tells_the_frictions_of_motor_and_load_apart() {
    let folder = tempfile::tempdir().unwrap();
    let [log, calibration, slow, model] =
        ["run.mcap", "torque.toml", "slow.toml", "model.toml"].map(|name| path(&folder, name));
    std::fs::write(&calibration, run(["template", "calibration", "gearmotor-torque"]).done()).unwrap();
    std::fs::write(&slow, SLOW).unwrap();
    let hidden = format!("coulomb_friction@load_bearing:torque={FRICTION_NM}");
    let bench = ["record", "-o", &log, "--device", "sim", "--model", "gearmotor", "--hide", &hidden];
    let ran = run(bench.iter().chain(&["--calibration", &calibration, "--profile", &slow, "--json"])).json();
    assert_eq!(ran["end"], "finished", "{ran}");
    let text = run(["template", "model", "gearmotor"]).done();
    std::fs::write(&model, text.replacen("[parameters]\n", PARAMETERS, 1) + MODEL).unwrap();
    let fitted = run(["identify", &format!("{log}@1.5..5"), "--model", &model, "--json"]).json();
    let entries = fitted["parameters"].as_array().unwrap();
    // The frictions of motor and load are one without a torque between them.
    for (name, truth) in [("friction_load", FRICTION_NM), ("friction_motor", 1.5e-3)] {
        let found = entries.iter().find(|entry| entry["name"] == name).unwrap();
        println!("measured: {name} by a fit: {} in {}, truth {truth}", found["value"], found["ci95"]);
        let ends = [0, 1].map(|end| found["ci95"][end].as_f64().unwrap());
        assert!(ends[0] < truth && truth < ends[1] && ends[1] - ends[0] < 0.3 * truth, "{found}");
    }
}

/// Each with its sentence, and the longest time until the bridge is off, s.
const FAILURES: [(&str, &str, f64); 4] = [
    (
        "transducer=silent",
        "output_torque is silent: its converter has sent no valid conversion for 350 ms",
        0.38,
    ),
    ("transducer=shorted", "output_torque is silent", 0.38),
    ("transducer=saturated", "output_torque is saturated: it reads 8388607 counts", 0.04),
    ("transducer=stuck", "output_torque is stuck", 0.55),
];

#[test]
fn a_transducer_that_fails_is_named_has_no_values_and_stops_the_run() {
    let Some(mut bench) = bench() else { return };
    let (log, profile) = (path(&bench.folder, "run.mcap"), path(&bench.folder, "steady.toml"));
    for (what, says, within_s) in FAILURES {
        bench.board.inject(what, Some(0.4));
        let ran = bench.record(&log, &profile, &[]);
        let events = bench.board.log();
        let injected = events.iter().rfind(|event| event.what == "injected").unwrap().at_s;
        let off = events.iter().find(|event| event.at_s >= injected && event.what == "enable").unwrap().at_s;
        println!("measured: {what}: bridge off after {:.1} ms", (off - injected) * 1e3);
        assert!(off - injected < within_s, "{what}: {events:?}");
        assert!(ran.code == Some(1) && format!("{ran:?}").contains(says), "{what}: {ran:?}");
        // About 0.4 s of conversions, and of a converter that repeats itself the repetitions.
        let count = conversions(&log).len();
        assert!((30..45).contains(&count) || what.ends_with("stuck"), "{what}: {count} conversions");
        bench.board.inject("transducer=well", None);
        bench.board.run_for(0.3);
    }
    // One that is silent does not delay what stops the bench.
    bench.board.inject("transducer=silent", Some(0.2));
    bench.board.inject("open-stop", Some(0.3));
    let ran = bench.record(&log, &profile, &[]);
    assert!(format!("{ran:?}").contains("emergency stop"), "{ran:?}");
    let events = bench.board.log();
    let injected = events.iter().rfind(|event| event.what == "injected").unwrap().at_s;
    let off = events.iter().find(|event| event.at_s >= injected && event.what == "enable").unwrap().at_s;
    assert!(off - injected < 1e-5, "{events:?}");
}
