//! The firmware's image on the emulated board: what it records, how long it takes, and what the processor makes of the core's arithmetic.

use serde_json::json;
use socam_core::{Board, ConverterSilent, Ports, Request, Ring};
use socam_model::Model;
use socam_recording::{Calibration, Dataset, ProfileFile};
use socam_tests::emulator::{Emulator, FILTERS, bench};
use socam_tests::firmware::limit;
use socam_tests::{path, run};

/// A profile for the closed velocity loop: all odd lines from 0.5 to 60 Hz about 860 rpm.
const CLOSED_LOOP: &str = "
command = 'speed'
control = 'closed_loop'
shape = 'multisine'
offset_rad_s = 90
amplitude_rad_s = 10
lines = 'odd'
from_Hz = 0.5
to_Hz = 60
period_s = 2
seed = 1
ramp_s = 1
limit_rad_s = 140
slew_rad_s2 = 4000
duration_s = 9
";

/// Another one: up and down through standstill.
const HELD_OUT: &str = "
command = 'speed'
control = 'closed_loop'
shape = 'triangle'
amplitude_rad_s = 110
period_s = 4
limit_rad_s = 140
slew_rad_s2 = 4000
ramp_s = 0.5
duration_s = 9
";

/// Clock cycles of the board's processor per microsecond.
const CYCLES_PER_US: f64 = 125.0;

const CHANNELS: [&str; 5] =
    ["command_V", "motor_speed_rad_s", "output_speed_rad_s", "torque_in_Nm", "torque_out_Nm"];

/// The default bench's calibration on this board's converters.
fn calibration() -> Calibration {
    let mut calibration = Calibration::default();
    calibration.input.full_scale_v = 10.24;
    calibration
}

/// Records on the emulated board; all samples must arrive. Returns what was measured of the sampling interrupt.
fn record(board: &mut Emulator, log: &str, profile: &str, duration: &str, rate: u32) -> serde_json::Value {
    let _ = board.ask(&json!({ "ask": "reset-measured" }));
    let rate_text = rate.to_string();
    let recorded = run([
        "record",
        "-o",
        log,
        "--device",
        &board.device,
        "--profile",
        profile,
        "--duration",
        duration,
        "--rate",
        &rate_text,
        "--json",
    ])
    .json();
    assert_eq!((&recorded["lost"], &recorded["end"]), (&json!(0), &json!("finished")), "{recorded}");
    let step_us = 1_000_000 / rate / socam_core::conversions_per_sample(1_000_000 / rate);
    let measured = board.ask(&json!({ "ask": "measured", "stepUs": step_us }));
    let stack_bytes = measured["stackBytes"].as_u64().unwrap() + limit("interrupt_stack_bytes");
    assert!(stack_bytes <= limit("stack_bytes"), "{measured}");
    let busy_us = measured["meanCycles"].as_f64().unwrap() / CYCLES_PER_US;
    println!(
        "measured: {rate} Hz {profile}: sampling takes {:.1} % of the time",
        100.0 * busy_us / f64::from(step_us)
    );
    measured
}

fn profile(folder: &tempfile::TempDir, name: &str, text: &str) -> String {
    let file = path(folder, name);
    std::fs::write(&file, format!("schema = 'socam.profile/1'\n{text}")).unwrap();
    file
}

fn columns(log: &str) -> Vec<Vec<f64>> {
    let loaded = Dataset::open(log).unwrap().load(&CHANNELS).unwrap();
    loaded.columns.iter().map(|column| column.values().to_vec()).collect()
}

/// The bench's counts as they were recorded, for a core that runs on this machine.
struct Replayed {
    rows: std::vec::IntoIter<[i16; 4]>,
    now_us: u64,
    output: i16,
}

impl Ports for Replayed {
    type Count = i16;

    fn now_us(&mut self) -> u64 {
        self.now_us
    }
    fn read(&mut self, counts: &mut [i16]) -> Result<(), ConverterSilent> {
        counts.copy_from_slice(&self.rows.next().unwrap_or_default());
        Ok(())
    }
    fn write(&mut self, count: i16) -> Result<(), ConverterSilent> {
        self.output = count;
        Ok(())
    }
    fn enable(&mut self, _: bool) {}
}

/// Runs the core here on recorded counts and returns the counts that it commands.
fn replay(profile: &str, columns: &[Vec<f64>]) -> Vec<i16> {
    let calibration = calibration();
    let counts = |row: usize| {
        std::array::from_fn(|channel| {
            let volts = calibration.channels[channel].sensor.volts(columns[channel + 1][row]);
            calibration.input.count(volts)
        })
    };
    let rows: Vec<[i16; 4]> = (0..columns[0].len()).map(counts).collect();
    let mut ring = Ring::<i16, 4>::new();
    let (producer, mut samples) = ring.split();
    let mut board = Board::new(Replayed { rows: rows.into_iter(), now_us: 0, output: 0 }, producer);
    let profile = ProfileFile::open(profile).unwrap().profile(1000).unwrap();
    for request in [
        Request::Configure(calibration.config(1000).unwrap()),
        Request::Load(profile),
        Request::Arm,
        Request::Stream(true),
        Request::Run,
    ] {
        board.handle(request).unwrap();
    }
    (0..columns[0].len())
        .map(|_| {
            board.handle(Request::Heartbeat).unwrap();
            board.ports_mut().now_us += 1000;
            board.tick();
            samples.pop().unwrap().output_count
        })
        .collect()
}

#[test]
fn a_closed_loop_run_matches_the_virtual_board() {
    let Some(mut board) = Emulator::start(bench(&[], 7)) else { return };
    let folder = tempfile::tempdir().unwrap();
    let (emulated, simulated) = (path(&folder, "emulated.mcap"), path(&folder, "virtual.mcap"));
    let profile = profile(&folder, "loop.toml", CLOSED_LOOP);
    let measured = record(&mut board, &emulated, &profile, "10s", 1000);
    println!("measured: 1 kHz closed loop: {measured}");
    assert!(measured["worstCycles"].as_u64().unwrap() <= 12_000, "{measured}");
    // The firmware reports this step to its host.
    assert!((measured["channelStepNs"].as_f64().unwrap() - 3700.0).abs() < 50.0, "{measured}");

    let file = path(&folder, "pico.toml");
    let text =
        run(["template", "calibration"]).done().replacen("full_scale_V = 10\n", "full_scale_V = 10.24\n", 1);
    std::fs::write(&file, text).unwrap();
    let arguments =
        ["record", "-o", &simulated, "--device", "sim", "--calibration", &file, "--profile", &profile];
    let _ = run(arguments.iter().chain(&["--duration", "10s"])).done();
    let (ours, theirs) = (columns(&emulated), columns(&simulated));
    // The bench's sensor noise in both, and what it stirs up in the closed loop; the board's command acts 0.06 ms later,
    // and each microsecond more adds 0.02 at the input torque.
    for (channel, noise) in [(1, 0.02), (2, 0.01), (3, 2e-3), (4, 1e-2)] {
        let squares: f64 = ours[channel].iter().zip(&theirs[channel]).map(|(a, b)| (a - b).powi(2)).sum();
        let rms = (squares / ours[channel].len() as f64).sqrt() / (std::f64::consts::SQRT_2 * noise);
        println!("measured: {}: differs by {rms:.2} times the noise of both", CHANNELS[channel]);
        assert!((0.5..2.2).contains(&rms), "{}: {rms}", CHANNELS[channel]);
    }

    // Equal counts lead to equal commands on a Cortex-M0+ and here, bit by bit.
    let commands: Vec<i16> = ours[0].iter().map(|volts| calibration().output.count(*volts)).collect();
    assert_eq!(replay(&profile, &ours), commands);
}

/// The parameters of the default bench in their intervals.
fn assert_identified(recording: &str, model: &str) {
    let result = run(["identify", recording, "--model", model, "--json"]).json();
    let found = |list: &str, name: &str| {
        let entry =
            result[list].as_array().unwrap().iter().find(|entry| entry["name"] == name).unwrap().clone();
        (entry["ci95"][0].as_f64().unwrap(), entry["ci95"][1].as_f64().unwrap())
    };
    let model = Model::builtin("speed-o-cam").unwrap();
    let truth = |name: &str| model.parameters.iter().find(|parameter| parameter.name == name).unwrap().value;
    let series = |a: &str, b: &str| 1.0 / (1.0 / truth(a) + 1.0 / truth(b));
    for (list, name, truth) in [
        ("parameters", "k4", truth("k4")),
        ("parameters", "c4", truth("c4")),
        ("parameters", "c5", truth("c5")),
        ("combinations", "k_series_12", series("k1", "k2")),
        ("combinations", "k_series_34", series("k3", "k4")),
    ] {
        let (low, high) = found(list, name);
        println!("measured: {name}: {truth} in [{low}, {high}]");
        // Intervals of 95 %, widened to what one in a million leaves.
        let margin = 0.75 * (high - low);
        assert!((low - margin..high + margin).contains(&truth), "{name} is {truth}, not in [{low}, {high}]");
    }
}

/// Neither the filters nor the properties of the converter are mistaken for a sensor's lag or delay, and the bench's fault is
/// found.
#[test]
fn recordings_of_the_board_are_diagnosed_and_identified() {
    let friction = "coulomb_friction@load_bearing:torque=0.3";
    let Some(mut board) = Emulator::start(bench(&[&FILTERS[..], &[friction]].concat(), 8)) else { return };
    let folder = tempfile::tempdir().unwrap();
    let [training, held_out] = [("loop", CLOSED_LOOP), ("held_out", HELD_OUT)].map(|(name, text)| {
        let log = path(&folder, &format!("{name}.mcap"));
        let _ = record(&mut board, &log, &profile(&folder, &format!("{name}.toml"), text), "10s", 1000);
        log
    });
    let corrected = path(&folder, "corrected.toml");
    let arguments = ["diagnose", &training, "--holdout", &held_out, "--write-model", &corrected, "--json"];
    let document = run(arguments).json();
    let findings = document["findings"].as_array().unwrap();
    assert_eq!(findings.len(), 1, "{}", document["findings"]);
    let torque_nm = findings[0]["parameters"][0]["value"].as_f64().unwrap();
    println!(
        "measured: hidden {friction}: {} at {}: {torque_nm} N m",
        findings[0]["effect"], findings[0]["location"]
    );
    assert_eq!(findings[0]["effect"], "coulomb_friction");
    assert_eq!(findings[0]["location"], "load_bearing");
    assert!((torque_nm - 0.3).abs() < 0.01, "{torque_nm}");
    for channel in ["output_speed", "torque_in", "torque_out"] {
        let delay = document["not_found"].as_array().unwrap().iter();
        let delay = delay.filter(|one| one["effect"] == "sensor_delay" && one["location"] == channel);
        let smallest_us = delay.map(|one| 1e6 * one["smallest_detectable"].as_f64().unwrap()).next().unwrap();
        println!("measured: a delay of {channel} would have been seen from {smallest_us:.1} us on");
        assert!(smallest_us < 40.0, "{channel}: {smallest_us} us");
    }
    assert_identified(&training, &corrected);
}

#[test]
fn every_profile_runs_and_is_the_hosts_own_bit_by_bit() {
    let Some(mut board) = Emulator::start(bench(&[], 7)) else { return };
    let folder = tempfile::tempdir().unwrap();
    for profile in ProfileFile::built_in_names().filter(|name| *name != "gearmotor") {
        let (ours, theirs) = (path(&folder, "board.mcap"), path(&folder, "virtual.mcap"));
        let _ = std::fs::remove_file(&ours);
        let measured = record(&mut board, &ours, profile, "2.5s", 1000);
        println!("measured: 1 kHz {profile}: {measured}");
        assert!(
            measured["worstCycles"].as_u64().unwrap() <= limit("interrupt_cycles_1_khz"),
            "{profile}: {measured}"
        );
        let arguments = ["record", "--force", "-o", &theirs, "--device", "sim", "--profile", profile];
        let _ = run(arguments.iter().chain(&["--duration", "2.5s"])).done();
        assert_eq!(columns(&ours)[0], columns(&theirs)[0], "{profile}");
    }
    let info = run(["info", &path(&folder, "board.mcap")]).done();
    for known in [
        "ADS8688",
        "firmware: 0.1.0 ",
        "mean skew between channels 0 ns",
        "0 link errors",
        "enable_read_back: at the board's pin only",
    ] {
        assert!(info.contains(known), "{info}");
    }
    let mut last = |what: &str| board.log().into_iter().rfind(|happened| happened.what == what).unwrap();
    assert_eq!((last("enable").value, last("volts").value), (json!(false), json!(0)));
}

#[test]
fn five_kilohertz_lose_nothing_and_take_their_time() {
    let Some(mut board) = Emulator::start(bench(&[], 7)) else { return };
    let folder = tempfile::tempdir().unwrap();
    board.inject("host=chatter", None);
    // The profile with the most to work out.
    let measured = record(&mut board, &path(&folder, "short.mcap"), "multisine", "2.5s", 5000);
    println!("measured: 5 kHz multisine, with random host traffic: {measured}");
    assert!(measured["worstCycles"].as_u64().unwrap() <= limit("interrupt_cycles_5_khz"), "{measured}");
    // The spread from the earliest to the latest instant, on a grid of exactly 100 us, is at most a quarter of the width of +-2 us.
    assert!(measured["spreadNs"].as_f64().unwrap() <= limit("instant_spread_ns") as f64, "{measured}");
    board.inject("host=alone", None);
    let measured = record(&mut board, &path(&folder, "long.mcap"), "chirp", "6s", 5000);
    println!("measured: 5 kHz chirp: {measured}");
    assert!(measured["worstCycles"].as_u64().unwrap() <= limit("interrupt_cycles_5_khz"), "{measured}");
    assert_eq!(Dataset::open(&path(&folder, "long.mcap")).unwrap().rows(), 30_000);
}
