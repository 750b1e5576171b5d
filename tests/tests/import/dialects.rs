//! `info` and `check` give the same results for a table in any dialect or container.

#[path = "../../../crates/socam-import/tests/tables/mod.rs"]
mod tables;

use serde_json::Value;
use socam_tests::run;

const ROWS: usize = 2000;

fn wave(slope: u32) -> Vec<f64> {
    (0..ROWS).map(|row| f64::from((row as u32 * slope) % 997) / 8.0 - 62.0).collect()
}

/// Output of `info` on a file, without the file's name and format.
fn info(path: &str) -> Value {
    let mut document = run(["info", path, "--json"]).json();
    let mut recording = document["recordings"][0].take();
    let channels = recording["channels"].as_array_mut().unwrap();
    channels.sort_by_key(|channel| format!("{} {}", channel["name"], channel["unit"]));
    recording["warnings"].as_array_mut().unwrap().sort_by_key(Value::to_string);
    let names = ["rows", "start_s", "end_s", "sample_time_s", "channels", "gaps", "warnings"];
    names.map(|name| (name.to_owned(), recording[name].clone())).into_iter().collect()
}

#[test]
fn info_reads_what_check_reads() {
    let folder = tempfile::tempdir().unwrap();
    let table = [
        ("t_s", (0..ROWS).map(|row| row as f64 / 1000.0).collect()),
        ("command_V", wave(3)),
        ("motor_speed_rad_s", wave(5)),
        ("output_speed_deg_per_s", wave(7)),
        ("torque_in_mNm", wave(11)),
        ("torque_out_Nm", wave(13)),
        ("state", wave(17)),
    ];
    let paths = tables::write_all(folder.path(), &table);
    let truth = info(paths[0].to_str().unwrap());
    let units: Vec<&str> = truth["channels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|channel| channel["unit"].as_str().unwrap())
        .collect();
    assert_eq!(units, ["V", "rad/s", "rad/s", "N m", "N m"]);
    assert!(truth["warnings"][0].as_str().unwrap().contains("column `state` names no unit"), "{truth}");
    let checked = run(["check", paths[0].to_str().unwrap()]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    for path in &paths[1..] {
        let path = path.to_str().unwrap();
        let found = info(path);
        for (name, truth) in truth.as_object().unwrap() {
            assert_near(&found[name], truth, &format!("{name} of {path}"));
        }
        assert_eq!(run(["check", path]).code, checked.code, "{path}");
    }
}

/// Numbers are equal to 1e-9, everything else is equal.
#[track_caller]
fn assert_near(found: &Value, truth: &Value, what: &str) {
    match (found, truth) {
        (Value::Array(found), Value::Array(truth)) if found.len() == truth.len() => {
            found.iter().zip(truth).for_each(|(found, truth)| assert_near(found, truth, what));
        }
        (Value::Object(found), Value::Object(truth)) => {
            truth
                .iter()
                .for_each(|(name, truth)| assert_near(&found[name], truth, &format!("{name} in {what}")));
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0), "{what}: {a} is not {b}");
        }
        _ => assert_eq!(found, truth, "{what}"),
    }
}
