//! Ctrl-C during a fit: the first ends the search with its best result, the second ends it at once and leaves no file half-written.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use socam_tests::bench::BENCH;
use socam_tests::{Ran, run, socam_host};

/// A fit that would take very long, once its search has begun.
fn searching(folder: &Path) -> Child {
    let recording = folder.join("run.csv");
    std::fs::write(&recording, BENCH.csv(6.0, 1)).unwrap();
    let mut command = socam_host();
    command.arg("identify").arg(recording).args([
        "--starts",
        "1000",
        "--json",
        "--progress",
        "--write-model",
    ]);
    command.arg(folder.join("model.toml")).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let said = BufReader::new(child.stderr.as_mut().unwrap()).lines().next().unwrap().unwrap();
    // Starts run side by side: any of them may be the first to say so.
    assert!(said.starts_with("start ") && said.contains(" of 1000, step 0, chi2/n "), "{said}");
    child
}

/// Whether the model is half-written.
fn has_part(folder: &Path) -> bool {
    let names = folder.read_dir().unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    names.into_iter().any(|name| name.starts_with("model.toml.") && name.ends_with(".part"))
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
    let result = Ran::from(child.wait_with_output().unwrap()).json();
    assert_eq!(result["end"], "interrupted");
    assert_eq!(result["converged"], false);
    let warnings = result["warnings"].as_array().unwrap();
    let said = |text: &str| warnings.iter().any(|warning| warning.as_str().unwrap().contains(text));
    assert!(said("the search was interrupted"), "{warnings:?}");
    let determined = result["parameters"].as_array().unwrap().iter().filter(|p| p["identifiable"] == true);
    assert!(determined.clone().count() > 0 && determined.clone().all(|p| p["std"].as_f64().unwrap() > 0.0));
    let model = folder.path().join("model.toml");
    assert!(std::fs::read_to_string(&model).unwrap().contains("interrupted search"));
    assert!(!has_part(folder.path()));
    // The fit continues from the file that was written.
    let arguments = ["identify", "--starts", "1", "--model", model.to_str().unwrap(), "--json"];
    let recording = folder.path().join("run.csv");
    let resumed = run(arguments.into_iter().chain([recording.to_str().unwrap()])).json();
    assert_eq!(resumed["converged"], true);
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
    let left: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().file_name()).collect();
    assert_eq!(left, ["run.csv"]);
}
