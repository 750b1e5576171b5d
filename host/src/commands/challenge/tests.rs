use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Parser;
use serde_json::json;

use super::*;

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    args: Args,
}

fn args(words: &[&str]) -> Args {
    Line::try_parse_from([&["challenge"], words].concat())
        .map_or_else(|error| panic!("{error}"), |line| line.args)
}

/// Finds nothing, ever.
fn adequate(_: &Model, _: &[Dataset], _: &[Dataset]) -> Result<Diagnosis, String> {
    serde_json::from_value(json!({
        "schema": "socam.diagnosis/1", "verdict": "adequate", "false_alarm_rate": 0.01, "validation": "holdout",
        "findings": [], "fit": {"channels": {}}, "parameters": [], "not_found": [], "suggested_experiment": null,
        "cpu_s": 2.0, "warnings": [],
    }))
    .map_err(|error| error.to_string())
}

#[test]
fn ranges_are_read() {
    assert_eq!(args(&["--cases", "3..7"]).cases, 3..7);
    for wrong in ["3", "3..", "7..3", "a..b"] {
        assert!(Line::try_parse_from(["challenge", "--cases", wrong]).is_err(), "{wrong}");
    }
}

#[test]
fn a_case_is_sealed_diagnosed_scored_and_not_done_again() {
    let dir = tempfile::tempdir().unwrap();
    let folder = Folder::open(dir.path()).unwrap();
    let asked = AtomicUsize::new(0);
    let diagnose = |model: &Model, training: &[Dataset], holdout: &[Dataset]| {
        asked.fetch_add(1, Ordering::Relaxed);
        assert_eq!((training.len(), holdout.len()), (4, 2));
        assert_eq!(model.text, Model::builtin("speed-o-cam").unwrap().text);
        assert!(training.iter().chain(holdout).all(|data| data.name().starts_with("run ")));
        // The truth is on disk and sealed by now.
        assert_eq!(folder.read::<Case>(1, 0, File::Sealed).unwrap().kind, Kind::Clean);
        assert!(folder.read::<Score>(1, 0, File::Score).is_err());
        adequate(model, training, holdout)
    };
    let args = args(&["--cases", "0..1"]);
    let (scores, failures) = score_all(&args, 2, &folder, &diagnose).unwrap();
    assert!(failures.is_empty() && scores.len() == 1 && scores[0].right);
    let (again, _) = score_all(&args, 1, &folder, &diagnose).unwrap();
    assert_eq!((again, asked.load(Ordering::Relaxed)), (scores.clone(), 1));
    let text = Report::new(1, scores).text();
    assert!(text.contains("nothing hidden"), "{text}");
}

#[test]
fn recordings_of_a_finished_case_can_be_had_too() {
    let dir = tempfile::tempdir().unwrap();
    let folder = Folder::open(dir.path()).unwrap();
    let asked = AtomicUsize::new(0);
    let diagnose = |model: &Model, training: &[Dataset], holdout: &[Dataset]| {
        asked.fetch_add(1, Ordering::Relaxed);
        adequate(model, training, holdout)
    };
    score_all(&args(&["--cases", "0..1"]), 1, &folder, &diagnose).unwrap();
    let again = args(&["--cases", "0..1", "--resume", "anywhere", "--recordings"]);
    let (scores, _) = score_all(&again, 1, &folder, &diagnose).unwrap();
    assert_eq!((scores.len(), asked.load(Ordering::Relaxed)), (1, 1));
    let kept = dir.path().join("seed-1-case-00000");
    let text = std::fs::read_to_string(kept.join("model.toml")).unwrap();
    assert_eq!(Model::parse(&text).unwrap().name, "speed-o-cam");
    let recordings = Case::draw(1, 0).unwrap().record().unwrap();
    for (name, recording) in
        [("training-4.csv", &recordings.training[3]), ("holdout-2.csv", &recordings.holdout[1])]
    {
        let read = crate::output::open(kept.join(name).to_str().unwrap()).unwrap();
        // Sums are taken in another order.
        let ends =
            |data: &Dataset| -> Vec<_> { data.statistics().iter().map(|own| (own.min, own.max)).collect() };
        assert_eq!((read.rows(), ends(&read)), (recording.rows(), ends(recording)));
    }
}

#[test]
fn recordings_of_a_locked_case_are_not_laid_out() {
    let dir = tempfile::tempdir().unwrap();
    let folder = Folder::open(dir.path()).unwrap();
    let args = args(&["--cases", "20..21", "--resume", "anywhere", "--recordings"]);
    for _ in ["first", "finished"] {
        let (scores, _) = score_all(&args, 1, &folder, &adequate).unwrap();
        assert!(scores.len() == 1 && scores[0].locked);
        assert!(!dir.path().join("seed-1-case-00020").exists());
    }
}

#[test]
fn locked_cases_are_left_alone_where_that_is_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let folder = Folder::open(dir.path()).unwrap();
    let (scores, failures) =
        score_all(&args(&["--cases", "20..40", "--open"]), 1, &folder, &adequate).unwrap();
    assert!(scores.is_empty() && failures.is_empty());
}

#[test]
fn clean_benches_can_be_tried_alone() {
    let dir = tempfile::tempdir().unwrap();
    let folder = Folder::open(dir.path()).unwrap();
    let (scores, failures) =
        score_all(&args(&["--cases", "0..4", "--clean"]), 2, &folder, &adequate).unwrap();
    assert!(failures.is_empty() && !scores.is_empty());
    assert!(scores.iter().all(|score| score.kind == Kind::Clean && score.right));
}
