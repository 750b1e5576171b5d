use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Parser;
use serde_json::json;
use socam_sim::challenge::Hidden;

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

/// A diagnosis that never finds anything.
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
        let case = Case::draw(1, 0).unwrap();
        assert_eq!((training.len(), holdout.len()), (case.training, case.runs.len() - case.training));
        assert_eq!(model.text, case.base().unwrap().text);
        assert!(training.iter().chain(holdout).all(|data| data.name().starts_with("run ")));
        // The truth is on disk and sealed by now.
        assert_eq!(folder.read::<Case>(1, 0, File::Sealed).unwrap().kind, CaseKind::Clean);
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
    assert_eq!(text, Case::draw(1, 0).unwrap().base().unwrap().text);
    let recordings = Case::draw(1, 0).unwrap().record().unwrap();
    for (name, recording) in
        [("training-3.csv", &recordings.training[2]), ("holdout-1.csv", &recordings.holdout[0])]
    {
        let read = crate::output::open(kept.join(name).to_str().unwrap()).unwrap();
        // The sums are computed in another order.
        let ends =
            |data: &Dataset| -> Vec<_> { data.statistics().iter().map(|own| (own.min, own.max)).collect() };
        assert_eq!((read.rows(), ends(&read)), (recording.rows(), ends(recording)));
    }
}

#[test]
fn clean_benches_can_be_tried_alone() {
    let dir = tempfile::tempdir().unwrap();
    let folder = Folder::open(dir.path()).unwrap();
    let (scores, failures) =
        score_all(&args(&["--cases", "0..4", "--clean"]), 2, &folder, &adequate).unwrap();
    assert!(failures.is_empty() && !scores.is_empty());
    assert!(scores.iter().all(|score| score.kind == CaseKind::Clean && score.right));
}

#[test]
fn one_family_can_be_tried_alone() {
    let dir = tempfile::tempdir().unwrap();
    let folder = Folder::open(dir.path()).unwrap();
    let args = args(&["--cases", "0..20", "--clean", "--family", "link"]);
    let (scores, failures) = score_all(&args, 1, &folder, &adequate).unwrap();
    assert!(failures.is_empty() && !scores.is_empty());
    assert!(scores.iter().all(|score| score.family == "link"));
}

/// On a rigid shaft a torque at one end is equivalent to a torque at the other end; friction is not.
#[test]
fn equivalence_is_computed_from_the_recordings() {
    let is_rigid =
        |number: &u64| CaseKind::of(*number) == CaseKind::Clean && family_of(1, *number) == "rigid-servo";
    let mut case = Case::draw(1, (0..400).step_by(2).find(is_rigid).unwrap()).unwrap();
    let machine = &case.machine;
    let pull = 0.2 * machine.amplitude * machine.input.scale;
    let parameters = vec![("torque".into(), pull)];
    case.kind = CaseKind::Single;
    case.hidden =
        vec![Hidden { effect: "constant_load".into(), place: "load".into(), parameters, own: Vec::new() }];
    let recordings = case.record().unwrap();
    let oracle = oracle::ask(&case, &recordings);
    assert!(oracle.detects_all(), "{oracle:?}");
    let named =
        |effect, place| oracle::is_equivalent(&case, &recordings, 0, (effect, place, &[("torque", pull)]));
    assert!(named("constant_load", "wheel"));
    assert!(!named("coulomb_friction", "load_bearing"));
}

/// Fits the base model to one clean machine, from start values that are wrong by up to three. Returns the ratio of residual to noise
/// variance by channel, and whether the true parameters are found.
fn fitted(case: &Case, max_iterations: usize) -> (Vec<f64>, bool) {
    let (base, recordings) = (case.base().unwrap(), case.record().unwrap());
    let options = socam_identify::Options { max_iterations, ..oracle::options(case) };
    let problem = socam_identify::Problem::new(&base, &recordings.training, options).unwrap();
    let fit = socam_identify::output_error(&problem).unwrap();
    let left = fit.fit.channels.iter().map(|(name, fit)| (fit.rms / case.noise_floor(name)).powi(2));
    let is_true = |known: &socam_sim::challenge::Parameter| {
        let found = fit.parameters.iter().find(|found| found.name == known.name).unwrap();
        // Parameters that the data do not determine have no value.
        found.value.is_none_or(|value| (value / known.value - 1.0).abs() < 0.03)
    };
    (left.collect(), case.machine.parameters.iter().all(is_true))
}

#[test]
fn truth_and_model_agree_where_nothing_is_hidden_and_only_there() {
    for family in FAMILY_NAMES.into_iter().filter(|family| *family != "speed-o-cam") {
        let first = |kind: CaseKind| {
            let mut numbers = (0..4000).step_by(2).filter(|number| CaseKind::of(*number) == kind);
            Case::draw(1, numbers.find(|number| family_of(1, *number) == family).unwrap()).unwrap()
        };
        let (left, is_true) = fitted(&first(CaseKind::Clean), 150);
        assert!(
            left.iter().all(|share| (0.9..1.25).contains(share)) && is_true,
            "{family}: {left:?} {is_true}"
        );
        let case = first(CaseKind::Single);
        // A fit that cannot succeed need not be finished.
        let (left, _) = fitted(&case, 10);
        assert!(left.iter().any(|share| *share > 1.3), "{family}: {:?} leaves {left:?}", case.hidden);
    }
}
