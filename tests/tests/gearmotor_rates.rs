//! The gearmotor board's image at its fastest rate, on an emulated RP2040.

use serde_json::json;
use socam_recording::Dataset;
use socam_tests::emulator::{Emulator, gearmotor};
use socam_tests::firmware::limit;
use socam_tests::{Ran, path, run};

const PROFILE: &str = "
schema = 'socam.profile/1'
command = 'voltage'
shape = 'multisine'
offset_V = 2
amplitude_V = 0.5
lines = 'odd'
from_Hz = 2
to_Hz = 40
period_s = 0.5
seed = 1
ramp_s = 0.1
limit_V = 8
slew_V_s = 2000
duration_s = 0.8
";

/// Samples per second, and the time between two conversions: a sample has two.
const RATE_HZ: f64 = 5000.0;
const STEP_US: u32 = 100;

/// Clock cycles of the board's processor per microsecond.
const CYCLES_PER_US: f64 = 125.0;

fn record(board: &Emulator, folder: &tempfile::TempDir, log: &str) -> Ran {
    let [calibration, profile] = ["mine.toml", "profile.toml"].map(|name| path(folder, name));
    std::fs::write(&calibration, run(["template", "calibration", "gearmotor"]).done()).unwrap();
    std::fs::write(&profile, PROFILE).unwrap();
    let arguments = ["record", "-o", log, "--device", &board.device, "--calibration", &calibration];
    run(arguments.iter().chain(&["--profile", &profile, "--rate", "5000", "--force", "--json"]))
}

#[test]
fn five_thousand_samples_a_second_arrive_and_agree_with_one_another() {
    let Some(mut board) = Emulator::start_gearmotor(gearmotor(&[], 3)) else { return };
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    // A host that says random bytes as well costs the link time, and may shift no sample.
    board.inject("host=chatter", Some(0.3));
    let ran = record(&board, &folder, &log).json();
    assert_eq!((&ran["end"], &ran["lost"]), (&"finished".into(), &0.into()), "{ran}");

    let measured = board.ask(&json!({ "ask": "measured", "stepUs": STEP_US }));
    let number = |name: &str| measured[name].as_f64().unwrap();
    let busy = number("meanCycles") / CYCLES_PER_US / f64::from(STEP_US);
    println!("measured: gearmotor at 5 kHz: sampling takes {:.1} % of the time: {measured}", 100.0 * busy);
    assert!(number("worstCycles") <= limit("gearmotor_interrupt_cycles_5_khz") as f64, "{measured}");
    assert!(number("spreadNs") < limit("instant_spread_ns") as f64, "{measured}");

    // Speed is the angle's derivative, and of the motor's voltage what winding and back-EMF do not take is the inductance's.
    let columns = ["motor_angle_rad", "motor_speed_rad_s", "motor_voltage_V", "motor_current_A"];
    let data = Dataset::open(&log).unwrap().load(&columns).unwrap();
    let [angle, speed, volts, amperes] = [0, 1, 2, 3].map(|column| data.columns[column].values().to_vec());
    assert!(angle.len() > 3900, "{} samples", angle.len());
    let turned = angle[angle.len() - 1] - angle[0];
    let summed: f64 = speed.iter().sum::<f64>() / RATE_HZ;
    assert!(turned > 20.0 && (summed / turned - 1.0).abs() < 2e-3, "{turned} rad, {summed} rad by speed");
    let rest = (0..angle.len()).map(|row| volts[row] - 2.2 * amperes[row] - 0.011 * speed[row]);
    let mean_v = rest.sum::<f64>() / angle.len() as f64;
    assert!(mean_v.abs() < 0.02, "{mean_v} V");
}

/// Checks are made at every sample: a current beyond its limit is two of these away from a bridge that is off.
#[test]
fn a_current_beyond_its_limit_ends_a_run_within_a_millisecond() {
    let Some(mut board) = Emulator::start_gearmotor(gearmotor(&[], 3)) else { return };
    let folder = tempfile::tempdir().unwrap();
    board.inject("reading=0@3.25", Some(0.2));
    let ran = record(&board, &folder, &path(&folder, "run.mcap"));
    assert!(ran.code == Some(1) && format!("{ran:?}").contains("over-current: motor_current"), "{ran:?}");
    let events = board.log();
    let injected = events.iter().rfind(|event| event.what == "injected").unwrap().at_s;
    let off = events.iter().find(|event| event.at_s >= injected && event.what == "enable").unwrap().at_s;
    println!("measured: gearmotor at 5 kHz: over-current: bridge off after {:.3} ms", (off - injected) * 1e3);
    assert!(off - injected < 1e-3, "{injected} s, {off} s");
}
