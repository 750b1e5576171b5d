//! The end of a search: by `--budget` or by the first Ctrl-C it ends with its best result, marked as unfinished. A budget is kept by an answer
//! like any other (exit code 0); an interrupted one (130) writes no model. The second Ctrl-C ends it at once and leaves no file half-written.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use socam_tests::bench::BENCH;
use socam_tests::{Ran, run, socam_host};

/// A fit that would take very long, once its search has begun.
fn searching(folder: &Path) -> Child {
    let recording = folder.join("run.csv");
    std::fs::write(&recording, BENCH.csv(6.0, 1)).unwrap();
    let mut command = socam_host();
    command.arg("identify").arg(recording).args(["--starts", "1000"]);
    let (child, said) = begun(command, folder);
    // Starts run side by side: any of them may be the first to say so.
    assert!(said.starts_with("start ") && said.contains(" of 1000, step 0, chi2/n "), "{said}");
    child
}

/// A command that writes a model and prints JSON, with the first line of its progress.
fn begun(mut command: Command, folder: &Path) -> (Child, String) {
    command.args(["--json", "--progress", "--write-model"]).arg(folder.join("model.toml"));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let said = BufReader::new(child.stderr.as_mut().unwrap()).lines().next().unwrap().unwrap();
    (child, said)
}

/// The diagnosis of three recordings of a bench by a model with a damping that is far too large.
fn diagnosis(folder: &Path) -> Command {
    let mut command = socam_host();
    command.arg("diagnose");
    for seed in 1..=3 {
        let recording = folder.join(format!("run{seed}.csv"));
        std::fs::write(&recording, BENCH.csv(6.0, seed)).unwrap();
        command.arg(recording);
    }
    command.args(["--fix", "c5=0.2"]);
    command
}

/// What holds of every diagnosis that was ended before its first choice.
fn assert_not_judged(document: &serde_json::Value, how: &str) {
    assert_eq!(document["schema"], "socam.diagnosis/1");
    assert_eq!(document["verdict"], "not_judged");
    assert_eq!(
        (&document["findings"], &document["not_found"]),
        (&serde_json::json!([]), &serde_json::json!([]))
    );
    let said = document["unfinished"].as_str().unwrap();
    assert!(said.starts_with(how) && said.ends_with("no effect was tried to its end."), "{said}");
    assert!(document["parameters"].as_array().unwrap().iter().any(|own| own["after"].is_number()));
}

/// Names of the files in a folder, in order.
fn names(folder: &Path) -> Vec<String> {
    let names = folder.read_dir().unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// Whether the model is half-written.
fn has_part(folder: &Path) -> bool {
    names(folder).iter().any(|name| name.starts_with("model.toml.") && name.ends_with(".part"))
}

/// Ctrl-C, as a terminal sends it.
fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

#[test]
fn an_interrupted_search_reports_its_best_point() {
    let folder = tempfile::tempdir().unwrap();
    let child = searching(folder.path());
    interrupt(&child);
    let ran = Ran::from(child.wait_with_output().unwrap());
    assert!(ran.stderr.contains("model.toml` was not written"), "{}", ran.stderr);
    let result = ran.unfinished_json("interrupted");
    assert_eq!(result["converged"], false);
    let warnings = result["warnings"].as_array().unwrap();
    let said = |text: &str| warnings.iter().any(|warning| warning.as_str().unwrap().contains(text));
    assert!(said("the search was interrupted after"), "{warnings:?}");
    // Whether starts were left out depends on how far the search had come.
    assert!(
        result["unfinished"].as_str().unwrap().starts_with("the search was interrupted after"),
        "{result}"
    );
    let determined = result["parameters"].as_array().unwrap().iter().filter(|p| p["identifiable"] == true);
    assert!(determined.clone().count() > 0 && determined.clone().all(|p| p["std"].as_f64().unwrap() > 0.0));
    assert_eq!(names(folder.path()), ["run.csv"]);
}

#[test]
fn a_fit_ends_within_its_budget() {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("run.csv");
    std::fs::write(&recording, BENCH.csv(6.0, 1)).unwrap();
    let with = |budget: &str, more: &[&str]| {
        let fixed = ["identify", recording.to_str().unwrap(), "--starts", "1000", "--budget", budget];
        run(fixed.iter().chain(more))
    };
    let model = folder.path().join("model.toml");
    let model = model.to_str().unwrap();
    let result = with("1ms", &["--json", "--write-model", model]).unfinished_json("budget");
    assert_eq!(result["converged"], false);
    // What a fit leaves before its end says nothing of missing physics.
    assert!(result.get("suspects").is_none_or(|all| all.as_array().unwrap().is_empty()), "{result}");
    assert!(std::fs::read_to_string(model).unwrap().contains("unfinished search"));
    // The fit continues from the file that was written.
    let arguments = ["identify", "--starts", "1", "--json", "--model", model, recording.to_str().unwrap()];
    let resumed = run(arguments).json();
    assert_eq!((&resumed["converged"], &resumed["finished"]), (&true.into(), &true.into()));
    assert!(resumed.get("unfinished").is_none());
    let text = with("1ms", &[]);
    let first = text.stdout.lines().next().unwrap();
    assert!(
        first.starts_with("The search was ended after ") && first.contains("999 of 1000 starts"),
        "{first}"
    );
    assert!(!text.stderr.contains("the search was ended"), "said twice: {}", text.stderr);
    assert!(with("never", &[]).refusal(2).contains("--budget"));
}

#[test]
fn a_diagnosis_ends_within_its_budget() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model.toml");
    let within = |budget: &str| {
        let since = Instant::now();
        let mut command = diagnosis(folder.path());
        command.args(["--json", "--budget", budget, "--force", "--write-model"]).arg(&model);
        (Ran::from(command.output().unwrap()), since.elapsed())
    };
    // What remains to be done without any time for the search, on this machine.
    let (ran, least) = within("1ms");
    assert_not_judged(&ran.unfinished_json("budget"), "The search was ended after ");
    assert!(std::fs::read_to_string(&model).unwrap().contains("unfinished diagnosis"));
    let (ran, elapsed) = within("2s");
    assert!(elapsed < 3 * (Duration::from_secs(2) + least), "{elapsed:?}, {least:?} without a search");
    // A machine of another age may finish it.
    assert!(ran.json()["findings"].is_array());
}

#[test]
fn an_interrupted_diagnosis_says_what_it_has() {
    let folder = tempfile::tempdir().unwrap();
    // An earlier model is left as it was.
    let (model, report) = (folder.path().join("model.toml"), folder.path().join("report"));
    std::fs::write(&model, "earlier").unwrap();
    let mut command = diagnosis(folder.path());
    command.arg("--force").arg("--report").arg(&report);
    let (child, _) = begun(command, folder.path());
    interrupt(&child);
    let ran = Ran::from(child.wait_with_output().unwrap());
    assert!(ran.stderr.contains("model.toml` was not written"), "{}", ran.stderr);
    assert_not_judged(&ran.unfinished_json("interrupted"), "The search was interrupted after ");
    assert_eq!(std::fs::read_to_string(&model).unwrap(), "earlier");
    assert!(!has_part(folder.path()));
    assert_eq!(names(&report), ["diagnosis.json", "index.html"]);
}

#[test]
fn a_second_interrupt_ends_at_once_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = searching(folder.path());
    assert!(has_part(folder.path()));
    interrupt(&child);
    // Signals that come too close are one.
    let heard = BufReader::new(child.stderr.as_mut().unwrap())
        .lines()
        .any(|line| line.unwrap().contains("once more"));
    assert!(heard);
    interrupt(&child);
    let ran = Ran::from(child.wait_with_output().unwrap());
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(130), ""), "{}", ran.stderr);
    assert_eq!(names(folder.path()), ["run.csv"]);
}
