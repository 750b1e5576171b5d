//! Calibrate, record with what was measured, measure losses, and design the next experiment, as a lab does day by day.

use std::fmt::Write;
use std::path::Path;

use serde_json::Value;
use socam_tests::run;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[track_caller]
fn holds(estimate: &Value, truth: f64) {
    let (value, std) = (number(&estimate["value"]), number(&estimate["std"]));
    assert!((value - truth).abs() < 5.0 * std, "{truth}: {estimate}");
}

/// Pairs of a tachometer of 7 V per 1000 rpm with a scatter of a hundredth of a volt. The third reading was noted wrongly.
fn pairs(path: &Path) {
    let mut text = String::from("# hand-held tachometer, voltmeter\nmotor_speed_rpm,motor_speed_V\n");
    for i in 1..=12 {
        let slip = if i == 3 { 0.8 } else { 0.0 };
        let scatter = 0.01 * [0.4, -1.0, 0.7, -0.2, 1.1, -0.9][i % 6];
        writeln!(text, "{},{:.4}", 100 * i, 0.02 + 7e-3 * 100.0 * i as f64 + scatter + slip).unwrap();
    }
    std::fs::write(path, text).unwrap();
}

#[test]
fn a_calibration_is_recorded_with_and_its_uncertainty_reaches_the_identification() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    pairs(Path::new(&at("tachometer.csv")));
    let picture = at("calibration.svg");
    let arguments =
        ["calibrate", &at("tachometer.csv"), "-o", &at("bench.toml"), "--plot", &picture, "--json"];
    let result = run(arguments).json();
    assert_eq!(result["schema"], "socam.calibration-result/1");
    let line = &result["tasks"][0]["line"];
    assert_eq!(line["outliers"], serde_json::json!([2]));
    holds(&line["gain"], 7e-3 / (std::f64::consts::TAU / 60.0));
    holds(&line["offset"], 0.02);
    assert!(result["warnings"][0].as_str().unwrap().contains("pairs 3 do not belong"));
    assert!(std::fs::read_to_string(&picture).unwrap().ends_with("</svg>\n"));

    let recorded =
        ["record", "--device", "sim", "--profile", "multisine", "--duration", "4s", "-o", &at("run.mcap")];
    let _ = run(recorded.into_iter().chain(["--calibration", &at("bench.toml")])).done();
    let identified = run(["identify", &at("run.mcap"), "--starts", "1", "--json"]).json();
    let parameters = identified["parameters"].as_array().unwrap();
    let gain = parameters.iter().find(|p| p["name"] == "motor_speed_sensor_gain_gain").unwrap();
    // The calibration knows it to 0.5 %; with a fixed ratio of the gear the other tachometer says the same.
    assert!((number(&gain["value"]) - 1.0).abs() < 0.01, "{gain}");
}

#[test]
fn a_static_test_of_a_coupling_becomes_a_prior() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let mut text = String::from("coupling_3_twist_deg,coupling_3_torque_Nm\n");
    for i in 0..10 {
        let scatter = 0.004 * [1.0, -0.7, 0.3, -0.5][i % 4];
        writeln!(text, "{},{:.4}", 0.2 * i as f64, 1.92 * 0.2 * i as f64 + scatter).unwrap();
    }
    std::fs::write(at("coupling.csv"), text).unwrap();
    let _ = run(["calibrate", &at("coupling.csv"), "--write-model", &at("known.toml")]).done();
    let model = socam_model::Model::parse(&std::fs::read_to_string(at("known.toml")).unwrap()).unwrap();
    let k4 = &model.parameters[model.parameter("k4").unwrap()];
    let prior = k4.prior.unwrap();
    assert!((prior.value - 1.92_f64.to_degrees()).abs() < 5.0 * prior.std && prior.std < 0.01 * prior.value);
    assert_eq!((k4.value, k4.source.as_str()), (prior.value, "static test"));

    let refused = run(["calibrate", &at("coupling.csv"), "-o", &at("bench.toml")]);
    assert!(refused.refusal(2).contains("--write-model takes what was measured of couplings"));
    assert!(!Path::new(&at("bench.toml")).exists());

    let backwards = "coupling_3_twist_deg,coupling_3_torque_Nm\n0,0\n0.2,-0.384\n0.4,-0.767\n0.6,-1.152\n";
    std::fs::write(at("backwards.csv"), backwards).unwrap();
    let refused = run(["calibrate", &at("backwards.csv"), "--write-model", &at("no.toml")]);
    assert!(refused.refusal(1).contains("turn the sign of one of them"));
    assert!(!Path::new(&at("no.toml")).exists());
}

#[test]
fn losses_are_measured_and_a_tachometers_gain_is_not_one_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let record = |name: &str, profile: &str, loss: &str| {
        let hidden = ["--hide", loss, "--hide", "sensor_gain@output_speed:gain=0.98"];
        let arguments = ["simulate", "--profile", profile, "--duration", "8s", "-o", name];
        let _ = run(arguments.into_iter().chain(hidden)).done();
    };
    let files = ["steps.mcap", "triangle.mcap", "old.mcap"].map(at);
    record(&files[0], "steps", "mesh_loss@mesh:fraction=0.08");
    record(&files[1], "triangle", "mesh_loss@mesh:fraction=0.08");
    record(&files[2], "steps", "mesh_loss@mesh:fraction=0.12");
    let result = run(["efficiency", &files[0], &files[1], "--json"]).json();
    assert_eq!(
        (&result["schema"], &result["kinematic_constraint"]),
        (&"socam.efficiency/1".into(), &true.into())
    );
    holds(&result["losses"]["torque_share"], 0.08);
    for point in result["points"].as_array().unwrap() {
        holds(&point["efficiency"], 0.92);
    }
    holds(&result["tachometers"]["ratio"], 0.98);
    assert_eq!(result["tachometers"]["disagree"], true);
    let warnings = result["warnings"].to_string();
    assert!(warnings.contains("was not counted as a loss"), "{warnings}");
    // Nothing tied: both tachometers count, and that is said.
    let slipping = run(["efficiency", &files[0], &files[1], "--slips", "--json"]).json();
    assert!(slipping["warnings"].to_string().contains("rests on the gains of motor_speed and output_speed"));
    let point = &slipping["points"][2]["efficiency"];
    assert!((number(&point["value"]) - 0.92 * 0.98).abs() < 2e-3, "{point}");

    let map = at("map.svg");
    let text = run(["efficiency", &files[0], &files[1], "--against", &files[2], "--map", &map]).done();
    let beside = text.split("Side by side").nth(1).unwrap_or_else(|| panic!("{text}"));
    assert!(beside.contains("+4.") || beside.contains("+3.9"), "{beside}");
    assert!(std::fs::read_to_string(&map).unwrap().matches("Efficiency (%)").count() == 2);
}

#[test]
fn a_designed_experiment_is_a_profile_that_runs() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let limits = ["--duration", "3s", "--limit", "torque_out=20", "--one-way"];
    let design = ["design", "-o", &at("next.toml"), "--json"];
    let result = run(design.into_iter().chain(limits)).json();
    assert_eq!((&result["schema"], &result["goal"]), (&"socam.design/1".into(), &"sharpest".into()));
    let width = |list: &str, name: &str| {
        let widths = result[list].as_array().unwrap();
        widths.iter().find(|w| w["name"] == name).and_then(|w| w["relative"].as_f64())
    };
    let (proposed, steps) = (width("widths", "k_series_12").unwrap(), width("reference", "k_series_12"));
    assert!(steps.is_none_or(|steps| proposed < 0.5 * steps), "{proposed} {steps:?}");
    let _ = run(["record", "--device", "sim", "--profile", &at("next.toml"), "-o", &at("next.mcap")]).done();
    let info = run(["info", &at("next.mcap"), "--json"]).json().to_string();
    assert!(info.contains("torque_out"), "{info}");
    assert!(run(["design", "--limit", "torque=3"]).refusal(2).contains("one of motor_speed, output_speed"));
}
