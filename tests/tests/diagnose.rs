//! `diagnose` as a user runs it: on benches with something concealed, and on one with nothing.

use std::path::Path;

use serde_json::Value;
use socam_tests::run;

/// True parameters of the bench; those of the model file differ.
const BENCH: [&str; 6] = ["k1=75", "k2=50", "k4=120", "c4=0.1", "c5=0.04", "c2=0.03"];
const TRAINING: [&str; 2] = ["multisine", "triangle"];
const HELD_OUT: &str = "reversals";

/// Records the profiles on a bench with something hidden in it.
fn record(folder: &Path, hidden: &[&str]) {
    for (seed, profile) in (101..).zip(TRAINING.iter().chain([&HELD_OUT])) {
        let target = folder.join(format!("{profile}.csv"));
        let seed = format!("{seed}");
        let mut arguments = vec!["simulate", "--profile", profile, "--duration", "5s", "--seed", &seed];
        arguments.extend(["-o", target.to_str().unwrap()]);
        arguments.extend(BENCH.iter().flat_map(|set| ["--set", set]));
        arguments.extend(hidden.iter().flat_map(|hide| ["--hide", hide]));
        assert_eq!(run(&arguments).code, Some(0), "{profile}");
    }
}

fn diagnosed(folder: &Path, more: &[&str]) -> Value {
    let path = |profile: &str| folder.join(format!("{profile}.csv")).to_str().unwrap().to_owned();
    let mut arguments = vec!["diagnose".to_owned()];
    arguments.extend(TRAINING.iter().map(|profile| path(profile)));
    arguments.extend(["--holdout".into(), path(HELD_OUT), "--json".into()]);
    arguments.extend(more.iter().map(|text| (*text).to_owned()));
    run(&arguments).json()
}

fn finding(document: &Value, index: usize) -> (&str, &str) {
    let finding = &document["findings"][index];
    (finding["effect"].as_str().unwrap(), finding["location"].as_str().unwrap())
}

#[test]
fn a_bench_that_its_model_explains_is_called_adequate() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), &[]);
    let document = diagnosed(folder.path(), &[]);
    assert_eq!(document["schema"], "socam.diagnosis/1");
    assert_eq!(document["verdict"], "adequate", "{}", document["findings"]);
    assert_eq!(document["validation"], "holdout");
    assert_eq!(document["findings"], serde_json::json!([]));
    for (name, channel) in document["fit"]["channels"].as_object().unwrap() {
        let ratio = channel["holdout_rms_after"].as_f64().unwrap() / channel["noise_std"].as_f64().unwrap();
        assert!((0.9..1.1).contains(&ratio), "{name}: {ratio}");
    }
    // The smallest detectable friction of the load's bearing is at most a hundredth of the friction in the test below.
    let unseen = document["not_found"].as_array().unwrap();
    let friction =
        unseen.iter().find(|one| one["effect"] == "coulomb_friction" && one["location"] == "load_bearing");
    let smallest = friction.unwrap()["smallest_detectable"].as_f64().unwrap();
    assert!((1e-5..3e-3).contains(&smallest), "{smallest}");
}

#[test]
fn concealed_friction_is_named_added_and_proven() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), &["coulomb_friction@load_bearing:torque=0.3"]);
    let report = folder.path().join("report");
    let model = folder.path().join("corrected.toml");
    let (report, model) = (report.to_str().unwrap(), model.to_str().unwrap());
    let why =
        ["--why", "coulomb_friction@load_bearing", "--why", "constant_load@load", "--why", "backlash@mesh"];
    let document =
        diagnosed(folder.path(), &[&["--report", report, "--write-model", model][..], &why].concat());
    assert_eq!(document["verdict"], "missing_physics");
    // Why the others are no findings: each was fitted in the friction's place too.
    let candidates = document["candidates"].as_array().unwrap();
    let asked: Vec<&Value> = candidates.iter().filter(|one| one["asked"] == true).collect();
    let fate = |effect: &str| *asked.iter().find(|one| one["effect"] == effect).unwrap();
    assert_eq!((asked.len(), &fate("coulomb_friction")["stage"]), (3, &Value::from("found")));
    for effect in ["constant_load", "backlash"] {
        let fate = fate(effect);
        assert!(
            fate["stage"] != "found" && fate["sentence"].as_str().unwrap().ends_with(|c| c != '.'),
            "{fate}"
        );
        let trials = fate["trials"].as_array().unwrap();
        assert!(!trials.is_empty(), "{fate}");
        let instead = trials.iter().find(|trial| trial["instead_of"][0] == "coulomb_friction");
        assert!(instead.is_none_or(|trial| trial["log_score"].as_f64().unwrap() < -1.0), "{fate}");
        assert!(trials.iter().all(|t| t["log_score"].as_f64() <= t["std"].as_f64()), "{fate}");
    }
    assert_eq!(finding(&document, 0), ("coulomb_friction", "load_bearing"));
    assert_eq!(document["findings"].as_array().unwrap().len(), 1, "{}", document["findings"]);
    let torque = &document["findings"][0]["parameters"][0];
    let ends = torque["ci95"].as_array().unwrap();
    assert!((torque["value"].as_f64().unwrap() - 0.3).abs() < 3e-3, "{torque}");
    assert!(ends[0].as_f64() < torque["value"].as_f64() && torque["value"].as_f64() < ends[1].as_f64());
    // The parameter that the missing effect had biased is correct again.
    let damping = document["parameters"].as_array().unwrap().iter().find(|one| one["name"] == "c5").unwrap();
    assert!((damping["before"].as_f64().unwrap() - 0.04).abs() > 0.005, "{damping}");
    assert!((damping["after"].as_f64().unwrap() - 0.04).abs() < 0.0005, "{damping}");
    for (name, channel) in document["fit"]["channels"].as_object().unwrap() {
        let number = |key: &str| channel[key].as_f64().unwrap();
        assert!(number("holdout_rms_before") > 1.5 * number("holdout_rms_after"), "{name}: {channel}");
        assert!(number("holdout_rms_after") < 1.15 * number("noise_std"), "{name}: {channel}");
    }
    for file in ["index.html", "diagnosis.json", "model.toml"] {
        assert!(Path::new(report).join(file).exists(), "{file}");
    }
    // The corrected model is a model file like any other.
    let held_out = folder.path().join(format!("{HELD_OUT}.csv"));
    let again = run(["identify", held_out.to_str().unwrap(), "--model", model, "--json"]).json();
    assert_eq!(again["converged"], true);
}

/// Steps hardly show how friction rises towards standstill; what a diagnosis proposes to record next does.
#[test]
#[ignore = "not reached: on steps in one direction a constant load is named, with the friction as a rival of 28 %"]
fn the_proposed_recording_settles_what_steps_leave_open() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let hidden = "stribeck_friction@load_bearing:torque=0.2,static_torque=0.3,stribeck_speed=0.5";
    let record = |profile: &str, seed: &str, to: &str| {
        let to = path(to);
        let arguments = ["simulate", "--profile", profile, "--seed", seed, "--hide", hidden, "-o", &to];
        assert_eq!(run(arguments.into_iter().chain(["--duration", "10s"])).code, Some(0));
    };
    let static_torque = |runs: &[&str]| {
        let runs: Vec<String> = runs.iter().map(|name| path(name)).collect();
        let arguments = ["diagnose"].into_iter().chain(runs.iter().map(String::as_str));
        let document = run(arguments.chain(["--json"])).json();
        assert_eq!(finding(&document, 0), ("stribeck_friction", "load_bearing"), "{}", document["findings"]);
        std::fs::write(path("diagnosis.json"), document.to_string()).unwrap();
        let own = document["findings"][0]["parameters"].as_array().unwrap();
        let ends = own.iter().find(|one| one["name"] == "static_torque").unwrap()["ci95"].clone();
        (ends[0].as_f64().unwrap(), ends[1].as_f64().unwrap())
    };
    record("steps", "1", "a.csv");
    record("steps", "2", "b.csv");
    let before = static_torque(&["a.csv", "b.csv"]);
    let (diagnosis, proposal) = (path("diagnosis.json"), path("apart.toml"));
    assert_eq!(run(["design", "--diagnosis", &diagnosis, "-o", &proposal]).code, Some(0));
    record(&proposal, "3", "c.csv");
    let after = static_torque(&["a.csv", "b.csv", "c.csv"]);
    assert!(after.1 - after.0 < 0.3 * (before.1 - before.0), "{before:?} {after:?}");
    assert!((after.0 - 0.002..after.1 + 0.002).contains(&0.3), "{after:?}");
}

#[test]
fn a_sensor_is_not_mistaken_for_the_plant() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), &["sensor_gain@torque_out:gain=0.96"]);
    let document = diagnosed(folder.path(), &[]);
    assert_eq!(finding(&document, 0), ("sensor_gain", "torque_out"), "{}", document["findings"]);
    let gain = document["findings"][0]["parameters"][0]["value"].as_f64().unwrap();
    assert!((gain - 0.96).abs() < 2e-3, "{gain}");
}

#[test]
fn hum_in_a_sensor_is_found_with_its_frequency() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), &["sensor_hum@torque_in:amplitude=0.02,frequency=50"]);
    let document = diagnosed(folder.path(), &[]);
    assert_eq!(finding(&document, 0), ("sensor_hum", "torque_in"), "{}", document["findings"]);
    assert_eq!(document["findings"].as_array().unwrap().len(), 1, "{}", document["findings"]);
    let own = &document["findings"][0]["parameters"];
    let [amplitude, frequency] = [0, 1].map(|k| own[k]["value"].as_f64().unwrap());
    assert!((amplitude - 0.02).abs() < 1e-3 && (frequency - 50.0).abs() < 0.01, "{amplitude} {frequency}");
}

#[test]
fn what_cannot_be_meant_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), &[]);
    let path = folder.path().join("triangle.csv");
    let path = path.to_str().unwrap();
    let refused = |arguments: &[&str], code: i32, words: &str| {
        let ran = run(arguments);
        assert_eq!(ran.code, Some(code), "{arguments:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(words) && ran.stdout.is_empty(), "{arguments:?}: {}", ran.stderr);
    };
    refused(&["diagnose", path, "--holdout", path], 2, "named twice");
    refused(&["diagnose", path, "--false-alarm-rate", "2"], 2, "between 0 and 1");
    refused(&["diagnose", path, "--why", "backlash"], 2, "EFFECT@PLACE");
    refused(&["diagnose", path, "--why", "rust@mesh"], 2, "there is no effect `rust`");
    refused(&["diagnose", path, "--why", "backlash@motor"], 2, "its places are mesh");
    let copy = folder.path().join("copy.csv");
    std::fs::copy(path, &copy).unwrap();
    refused(&["identify", path, "--validate", copy.to_str().unwrap()], 1, "holds the same samples");
    refused(&["diagnose", "nothing.csv"], 1, "nothing.csv");
    refused(&["diagnose", path, "--model", "two-mass"], 1, "motor_torque_Nm");
    refused(&["diagnose", path, "--report", path], 1, "directory");
}
