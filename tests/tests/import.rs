//! `import`: files that other programs wrote, tables in common dialects, mappings, and mistakes in all of these.

#[cfg(feature = "full")]
mod dialects;
mod mistakes;
mod named;
mod tables;

use std::path::Path;
use std::process::Command;

use socam_recording::Dataset;
use socam_tests::readers::{python, scripts};
use socam_tests::{path, run, skip};
use tempfile::TempDir;

/// Times and values of a recording's channels of these names.
fn columns(path: &Path, names: &[&str]) -> Vec<Vec<f64>> {
    let loaded = Dataset::open(path.to_str().unwrap()).unwrap().load(names).unwrap();
    let columns = loaded.columns.iter().map(|column| column.values().to_vec());
    std::iter::once(loaded.time_s.clone()).chain(columns).collect()
}

/// Files with the same motion in rpm and mN m, written by the libraries of their formats.
fn foreign_files(python: &Path) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let script = scripts().join("write_foreign.py");
    let output = Command::new(python).arg(script).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

const STATED: [&str; 17] = [
    "run.tdms",
    "run.mf4",
    "compressed.mf4",
    "run.mat",
    "run73.mat",
    "run.h5",
    "run.parquet",
    "run.feather",
    "run.arrows",
    "json.mcap",
    "protobuf.mcap",
    "run.wpilog",
    "run.ulg",
    "can/run.log",
    "can/run.asc",
    "can/run.blf",
    "run.db3",
];

/// Names of the channels with speed and torque, by file.
fn names_in(file: &str) -> [&str; 2] {
    match file {
        "json.mcap" => ["speed", "load_torque"],
        "run.wpilog" => ["drive_motor_speed", "drive_torque"],
        "run.ulg" => ["axis_motor_speed", "torque"],
        _ => ["motor_speed", "torque"],
    }
}

#[test]
#[cfg_attr(not(feature = "full"), ignore = "full tier")]
fn files_of_other_programs_hold_the_same_values() {
    let Some(python) = python() else {
        skip("no Python with the libraries of other formats (SOCAM_PYTHON names one)");
        return;
    };
    let folder = foreign_files(&python);
    let truth = columns(&folder.path().join("truth.csv"), &["motor_speed", "torque"]);
    let log = folder.path().join("imported.mcap");
    let target = log.to_str().unwrap();
    for name in STATED {
        let ran = run(["import", &path(&folder, name), "-o", target, "--force"]);
        assert_eq!(ran.code, Some(0), "{name}: {}", ran.stderr);
        let mut found = columns(&log, &names_in(name));
        // Logs of robots and buses count from another moment.
        let first_s = found[0][0];
        found[0].iter_mut().for_each(|time| *time -= first_s);
        assert_equal(name, &found, &truth);
        cut(&folder, name);
    }
    // Every kind of signal that a DBC knows, as cantools decodes it.
    let ran = run(["import", &path(&folder, "signals/signals.log"), "-o", target, "--force"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let names: Vec<String> = (0..20).map(|signal| format!("s{signal}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let decoded = columns(&folder.path().join("signals/truth.csv"), &names);
    for (name, (found, truth)) in names.iter().zip(columns(&log, &names)[1..].iter().zip(&decoded[1..])) {
        let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-12 * b.abs();
        assert!(found.len() == 200 && found.iter().zip(truth).all(is_same), "{name}");
    }
    // ROS states no units: its convention is proposed, and somebody has to agree.
    let (ros, map) = (path(&folder, "ros.mcap"), path(&folder, "ros.toml"));
    let ran = run(["import", &ros, "-o", target, "--force"]);
    let refused = ran.refusal(1);
    assert!(
        refused.contains("the unit of `velocity.motor`, by the convention of ROS \"rad/s\""),
        "{refused}"
    );
    let _ = run(["import", &ros, "--propose", "-o", &map]).done();
    let mut text = std::fs::read_to_string(&map).unwrap();
    for unit in ["rad/s", "rad/s", "N m"] {
        text = text.replacen("unit = \"?\"", &format!("unit = \"{unit}\""), 1);
    }
    std::fs::write(&map, text).unwrap();
    let _ = run(["import", &ros, "--map", &map, "-o", target, "--force"]).done();
    assert_equal("ros.mcap", &columns(&log, &["velocity_motor", "effort_motor"]), &truth);
    cut(&folder, "ros.mcap");
}

fn assert_equal(name: &str, found: &[Vec<f64>], truth: &[Vec<f64>]) {
    for (column, (found, truth)) in found.iter().zip(truth).enumerate() {
        assert_eq!(found.len(), truth.len(), "{name}");
        let worst = found.iter().zip(truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // The first column is the time, of which BLF counts whole nanoseconds.
        let least = if column == 0 { 1.5e-9 } else { 1e-12 };
        assert!(worst < least, "{name}, column {column}: {worst}");
    }
}

/// A file that is cut off is read up to there and says so, or refused in one sentence; so is one with zeros in its middle.
fn cut(folder: &TempDir, name: &str) {
    let bytes = std::fs::read(path(folder, name)).unwrap();
    let target = path(folder, "cut.mcap");
    for share in [2, 10, 50, 90, 99] {
        let cut = format!("{}.cut", path(folder, name));
        let left = &bytes[..bytes.len() * share / 100];
        std::fs::write(&cut, left).unwrap();
        let ran = run(["import", &cut, "-o", &target, "--force"]);
        match ran.code {
            // Lines that end where they should are a whole log.
            Some(0) => assert!(left.ends_with(b"\n"), "{name} at {share} %"),
            Some(3) => assert!(ran.stderr.contains("cut off"), "{name} at {share} %: {}", ran.stderr),
            _ => {
                let sentence = ran.refusal(1);
                let is_clear =
                    ["cut off", "damaged", "does not say"].iter().any(|word| sentence.contains(word));
                assert!(is_clear, "{name} at {share} %: {sentence}");
            }
        }
    }
}

#[test]
fn every_command_opens_a_file_that_states_its_units() {
    let folder = tempfile::tempdir().unwrap();
    let table = path(&folder, "scope.csv");
    let lines: String = (0..4000)
        .map(|k| {
            let t = 1e-3 * f64::from(k);
            format!("{:.3};{:.4};{:.4}\n", t * 1e3, 900.0 * (9.0 * t).sin(), 40.0 * (21.0 * t).cos())
                .replace('.', ",")
        })
        .collect();
    std::fs::write(&table, format!("Zeit [ms];Drehzahl [1/min];Moment [mNm]\n{lines}")).unwrap();
    let info = run(["info", &table]).done();
    assert!(info.contains("drehzahl") && info.contains("rad/s") && info.contains("1000"), "{info}");
    let exported = path(&folder, "si.csv");
    let _ = run(["export", &format!("{table}@1..2"), "-o", &exported]).done();
    let [time_s, speed, torque] = columns(Path::new(&exported), &["drehzahl", "moment"]).try_into().unwrap();
    assert_eq!((time_s.len(), time_s[0]), (1000, 1.0));
    assert!((speed[0] - 900.0 * 9.0_f64.sin() * std::f64::consts::TAU / 60.0).abs() < 1e-4);
    assert!((torque[0] - 0.04 * 21.0_f64.cos()).abs() < 1e-7);
}
