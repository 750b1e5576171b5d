//! `diagnose` on recordings as they come: with gaps, saturated, cut short, at other rates. Each ends in an answer or in one sentence.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use socam_tests::{Ran, run, socam_host};

/// A recording as rows of text.
#[derive(Clone)]
struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect());
        Self { header: lines.next().unwrap(), rows: lines.collect() }
    }

    fn write(&self, path: &Path) {
        let lines: Vec<String> =
            std::iter::once(&self.header).chain(&self.rows).map(|row| row.join(",")).collect();
        fs::write(path, lines.join("\n") + "\n").unwrap();
    }

    fn column(&self, name: &str) -> usize {
        self.header.iter().position(|own| own == name).unwrap()
    }

    /// The table with each cell of a column replaced by a function of its row and value.
    fn with(&self, name: &str, cell: impl Fn(usize, f64) -> String) -> Self {
        let (mut changed, column) = (self.clone(), self.column(name));
        for (k, row) in changed.rows.iter_mut().enumerate() {
            row[column] = cell(k, row[column].parse().unwrap());
        }
        changed
    }

    fn without(&self, name: &str) -> Self {
        let (mut changed, column) = (self.clone(), self.column(name));
        changed.header.remove(column);
        changed.rows.iter_mut().for_each(|row| {
            row.remove(column);
        });
        changed
    }

    fn rows(&self, keep: impl Fn(usize) -> bool) -> Self {
        let rows = self.rows.iter().enumerate().filter(|(k, _)| keep(*k)).map(|(_, row)| row.clone());
        Self { header: self.header.clone(), rows: rows.collect() }
    }
}

/// Required end of a diagnosis.
enum Ends {
    /// The friction is found, its relative error is below this, and warnings contain these words.
    Found(f64, &'static [&'static str]),
    /// A verdict, and words in its first finding's sentence.
    Says(&'static str, &'static str),
    /// An exit code and words of one sentence.
    Refused(i32, &'static [&'static str]),
}

use Ends::{Found, Refused, Says};

/// Torque of the hidden friction, N m.
const TRUTH: f64 = 0.3;

/// Names of training recordings, of held-out recordings, and the required end.
const CASES: [(&[&str], &[&str], Ends); 14] = [
    // Gaps, an empty stretch, a limit, another rate, and spikes, all at once.
    (
        &["damaged", "slow"],
        &["spiky_reversals"],
        Found(0.02, &["2 gaps", "torque_out is saturated", "torque_in has outliers in 3 places"]),
    ),
    (&["constant", "multisine"], &["reversals"], Found(0.01, &["torque_in never changes and was left out"])),
    (&["steps"], &[], Found(0.01, &["no recording was held out, so that nothing here is confirmed"])),
    (&["multisine@0..1"], &["reversals@0..1"], Says("missing_physics", "At load")),
    (&["multisine"], &["still"], Says("missing_physics", "At load bearing")),
    (&["constant"], &[], Refused(1, &["torque_in never changes in any recording", "connected"])),
    (&["still"], &["reversals"], Refused(1, &["motor_speed never changes in any recording", "connected"])),
    (&["lacking", "multisine"], &["reversals"], Refused(1, &["lacking.csv", "torque_in_Nm"])),
    (&["multisine@0..0.01"], &["reversals"], Refused(1, &["10 samples", "at least 20"])),
    (&["nan"], &["reversals"], Refused(1, &["nan.csv", "line 502", "NaN", "leave the cell empty"])),
    (&["steps"], &["copy"], Refused(1, &["copy.csv", "the same samples", "steps.csv"])),
    (&["steps@0..3"], &["steps@2..4"], Refused(2, &["samples in common", "held out"])),
    (&["empty"], &["reversals"], Refused(1, &["empty.csv", "0 bytes"])),
    (&["headless"], &["reversals"], Refused(1, &["headless.csv", "no samples"])),
];

fn path(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.csv"))
}

/// Simulates recordings with a hidden friction, and writes damaged copies of them.
fn write_recordings(folder: &Path) {
    for (seed, profile) in ["11", "12", "13"].into_iter().zip(["steps", "multisine", "reversals"]) {
        let target = path(folder, profile);
        let hide = format!("coulomb_friction@load_bearing:torque={TRUTH}");
        let arguments =
            ["simulate", "--profile", profile, "--duration", "4s", "--seed", seed, "--hide", &hide, "-o"];
        assert_eq!(run(arguments.into_iter().chain([target.to_str().unwrap()])).code, Some(0));
    }
    let [steps, multisine, reversals] =
        ["steps", "multisine", "reversals"].map(|name| Table::read(&path(folder, name)));
    let (torque_in, torque_out) = ("torque_in_Nm", "torque_out_Nm");
    let number = |value: f64| value.to_string();
    let spike = |k: usize, value: f64| number(value + if [901, 2000, 3333].contains(&k) { 2.0 } else { 0.0 });
    let limited = |k: usize, value: f64| {
        if k / 100 == 30 { String::new() } else { number(value.clamp(-1.2, 1.2)) }
    };
    let made = [
        ("damaged", steps.with(torque_out, limited).rows(|k| !(2000..2300).contains(&k) && k != 3500)),
        ("slow", multisine.rows(|k| k % 2 == 0)),
        ("spiky_reversals", reversals.with(torque_in, spike)),
        ("constant", steps.with(torque_in, |_, _| "0.5".into())),
        ("lacking", steps.without(torque_in)),
        ("nan", steps.with(torque_out, |k, value| if k == 500 { "NaN".into() } else { number(value) })),
        ("still", steps.with("motor_speed_rad_s", |_, _| "100".into())),
        ("copy", steps.clone()),
        ("headless", steps.rows(|_| false)),
    ];
    made.iter().for_each(|(name, table)| table.write(&path(folder, name)));
    fs::write(path(folder, "empty"), "").unwrap();
}

/// Diagnoses these recordings, whose names may end in a part such as `@0..1`.
fn diagnosed(folder: &Path, training: &[&str], holdout: &[&str]) -> Ran {
    let full = |name: &&str| {
        let (name, span) =
            name.split_once('@').map_or((*name, String::new()), |(n, span)| (n, format!("@{span}")));
        format!("{}{span}", path(folder, name).to_str().unwrap())
    };
    let mut arguments: Vec<String> = vec!["diagnose".into(), "--json".into(), "--most".into(), "1".into()];
    arguments.extend(training.iter().map(full));
    arguments.extend(holdout.iter().flat_map(|name| ["--holdout".into(), full(name)]));
    run(&arguments)
}

fn assert_ends(ran: Ran, ends: &Ends, said: &str) {
    match ends {
        Refused(code, words) => {
            let sentence = ran.refusal(*code);
            assert!(words.iter().all(|word| sentence.contains(word)), "{said}");
        }
        Found(within, words) => {
            let document = ran.json();
            let found = &document["findings"][0];
            assert_eq!(found["effect"], "coulomb_friction", "{said}{found}");
            assert_eq!(found["location"], "load_bearing", "{said}{found}");
            let torque = found["parameters"][0]["value"].as_f64().unwrap();
            assert!((torque / TRUTH - 1.0).abs() < *within, "{said}{torque}");
            let warnings = document["warnings"].as_array().unwrap();
            let is_said = |word: &&str| warnings.iter().any(|own| own.as_str().unwrap().contains(word));
            assert!(words.iter().all(is_said), "{said}{warnings:?}");
        }
        Says(verdict, words) => {
            let document = ran.json();
            assert_eq!(document["verdict"], *verdict, "{said}");
            let sentence = document["findings"][0]["sentence"].as_str().unwrap();
            assert!(sentence.contains(words), "{said}{sentence}");
        }
    }
}

/// The answer does not depend on the number of threads.
fn assert_same_with_any_number_of_threads(folder: &Path) {
    let [one, two] = ["1", "2"].map(|threads| {
        let mut command = socam_host();
        command.env("RAYON_NUM_THREADS", threads).args(["diagnose", "--json", "--most", "1"]);
        command.arg(path(folder, "multisine")).arg("--holdout").arg(path(folder, "reversals"));
        let output = command.output().unwrap();
        let mut document: Value = serde_json::from_slice(&output.stdout).unwrap();
        document["cpu_s"] = Value::Null;
        document
    });
    assert_eq!(one, two);
}

#[test]
fn every_recording_ends_in_an_answer_or_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    write_recordings(folder.path());
    for (training, holdout, ends) in &CASES {
        let ran = diagnosed(folder.path(), training, holdout);
        let said = format!("{training:?} {holdout:?}: {}", ran.stderr);
        assert_ends(ran, ends, &said);
    }
    assert_same_with_any_number_of_threads(folder.path());
}

/// Angles are counted from where a recording began, also in a part of it that is held out.
#[test]
fn one_recording_proves_what_comes_back_with_every_turn() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("steps.csv");
    let target = target.to_str().unwrap();
    let hide = "kinematic_error@mesh:order=1,amplitude=0.0004,phase=1";
    let arguments =
        ["simulate", "--profile", "steps", "--duration", "4s", "--seed", "12", "--hide", hide, "-o", target];
    assert_eq!(run(arguments).code, Some(0));
    let document = run(["diagnose", target, "--most", "1", "--json"]).json();
    assert_eq!(document["validation"], "blocks");
    assert_eq!(document["findings"][0]["effect"], "kinematic_error", "{document:#}");
    for (name, channel) in document["fit"]["channels"].as_object().unwrap() {
        let [rms, noise] = ["rms_after", "noise_std"].map(|key| channel[key].as_f64().unwrap());
        assert!(rms < 1.1 * noise, "{name}: {rms} of {noise}");
        // Blocks choose; nothing was held out to prove it.
        assert_eq!(channel["holdout_rms_after"], Value::Null, "{name}");
    }
    assert_eq!(document["held_out"], Value::Null);
}
