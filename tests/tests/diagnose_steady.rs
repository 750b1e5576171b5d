//! `diagnose` of steady states: tables 5.1 to 5.3 of X. Song, "The Parameter Identification of a Novel Speed Reducer", McGill, 2002.

use std::path::Path;

use serde_json::Value;
use socam_tests::run;

const TABLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tables");
const COUPLING: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/models/coupling-bench.toml");

fn finding<'d>(document: &'d Value, location: &str) -> &'d Value {
    let findings = document["findings"].as_array().unwrap();
    findings
        .iter()
        .find(|one| one["location"] == location)
        .unwrap_or_else(|| panic!("{location}: {findings:#?}"))
}

fn rivals(finding: &Value) -> Vec<(&str, &str, f64)> {
    let all = finding["rivals"].as_array().unwrap().iter();
    all.map(|one| {
        (one["effect"].as_str().unwrap(), one["location"].as_str().unwrap(), one["weight"].as_f64().unwrap())
    })
    .collect()
}

fn words(finding: &Value) -> &str {
    finding["sentence"].as_str().unwrap()
}

#[test]
fn the_reducers_table_has_a_loss_or_a_wrong_torque_sensor_and_speeds_that_scatter() {
    let folder = tempfile::tempdir().unwrap();
    let report = folder.path().join("report");
    let table = format!("{TABLES}/thesis-5.1.csv");
    let document = run(["diagnose", &table, "--json", "--report", report.to_str().unwrap()]).json();
    assert_eq!(document["verdict"], "missing_physics");
    // N tau_1 - tau_2 is 11.2, 11.9 and 11.4 % of N tau_1 whatever the torque; no recording of steady states says why.
    let loss = finding(&document, "mesh");
    assert_eq!(loss["effect"], "mesh_loss");
    let fraction = loss["parameters"][0]["value"].as_f64().unwrap();
    assert!((fraction - 0.115).abs() < 0.003, "{fraction}");
    let all = rivals(loss);
    for sensor in ["torque_in", "torque_out"] {
        let rival =
            all.iter().find(|(effect, place, _)| (*effect, *place) == ("sensor_gain", sensor)).unwrap();
        assert!((rival.2 - 1.0 / 3.0).abs() < 0.01, "{all:?}");
    }
    assert!(all.len() == 2 && words(loss).contains("88.76, 88.06, 88.62 %"), "{}", words(loss));
    // Gears allow one ratio; the two tachometers say three.
    let speeds = finding(&document, "output_speed");
    assert_eq!(speeds["effect"], "unexplained");
    assert!(
        words(speeds).contains("8.231, 8.042, 8.101") && words(speeds).contains("any one gain"),
        "{}",
        words(speeds)
    );
    assert!(speeds["evidence"]["p_value"].as_f64().unwrap() < 1e-6);
    // The load's torque falls while its speed triples: no viscous bearing does that.
    let load = finding(&document, "load_bearing");
    assert_eq!(load["effect"], "unexplained");
    assert_eq!(load["curve"]["torque"], serde_json::json!([4.8994, 4.823, 2.9265]));
    let c5 = document["parameters"].as_array().unwrap().iter().find(|one| one["name"] == "c5").unwrap();
    assert_eq!((&c5["identifiable"], &c5["after"]), (&Value::Bool(false), &Value::Null));
    // The proposed experiment is given as a sentence and as a profile that `record` reads.
    let next = &document["suggested_experiment"];
    let sentence = next["sentence"].as_str().unwrap();
    assert!(sentence.contains("load drives") && sentence.contains("weight"), "{sentence}");
    let profile = report.join("next.toml");
    let run_of_it = folder.path().join("next.mcap");
    let arguments = [
        "record",
        "--device",
        "sim",
        "--profile",
        profile.to_str().unwrap(),
        "--duration",
        "1s",
        "-o",
        run_of_it.to_str().unwrap(),
    ];
    assert_eq!(run(arguments).code, Some(0));
    for file in ["index.html", "diagnosis.json", "model.toml"] {
        assert!(Path::new(&report).join(file).exists(), "{file}");
    }
}

#[test]
fn the_couplings_lose_nothing_but_a_tachometer_is_off_by_two_per_cent() {
    let tables = ["5.2", "5.3"].map(|table| format!("{TABLES}/thesis-{table}.csv"));
    for chosen in [&tables[..1], &tables[1..], &tables[..]] {
        let mut arguments = vec!["diagnose", "--model", COUPLING, "--json"];
        arguments.extend(chosen.iter().map(String::as_str));
        let document = run(arguments).json();
        let speeds = finding(&document, "output_speed");
        assert_eq!(speeds["effect"], "sensor_gain");
        let gain = speeds["parameters"][0]["value"].as_f64().unwrap();
        assert!((gain - 0.981).abs() < 0.003, "{gain}");
        // The table does not determine which of the two tachometers is wrong, but it shows that nothing slips: the torque changes.
        let all = rivals(speeds);
        assert!(
            all.iter().any(|(effect, place, weight)| (*effect, *place) == ("sensor_gain", "motor_speed")
                && *weight > 0.4),
            "{all:?}"
        );
        assert!(all.iter().all(|(effect, ..)| *effect != "coupling_slip"), "{all:?}");
        // No torque is lost: what a loss would have had to be is said.
        let findings = document["findings"].as_array().unwrap();
        let at_torques = |one: &&Value| {
            ["torque_in", "torque_out", "coupling"].contains(&one["location"].as_str().unwrap())
        };
        assert!(!findings.iter().any(|one| at_torques(&one)), "{findings:?}");
        assert!(document["suggested_experiment"]["sentence"].as_str().unwrap().contains("tachometers"));
    }
}

#[test]
fn tables_and_recordings_do_not_mix() {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("run.csv");
    std::fs::write(&recording, "t_s,motor_speed_rad_s\n0,1\n0.001,2\n").unwrap();
    let (table, recording) = (format!("{TABLES}/thesis-5.1.csv"), recording.to_str().unwrap());
    let refused = |arguments: &[&str], code: i32, words: &str| {
        let ran = run(arguments);
        assert!(ran.refusal(code).contains(words), "{arguments:?}: {}", ran.stderr);
    };
    refused(&["diagnose", &table, recording], 2, "apart");
    refused(&["diagnose", &table, "--holdout", COUPLING], 2, "apart");
    refused(&["diagnose", &table, "--repeatability", "2"], 2, "between 0 and 0.5");
    refused(&["diagnose", recording, "--repeatability", "0.01"], 2, "steady states");
    refused(&["diagnose", &table, "--model", "two-mass"], 1, "nothing to compare");
}
