//! Held-out recordings: they are opened once, after the last choice, and an unusable recording prevents only the proof.

use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use socam_diagnose::document::{Diagnosis, ProofOutcome, Validation};
use socam_diagnose::{DiagnoseError, HeldOut, Options, diagnose, refuse_copies};
use socam_identify::{Observer, Progress, ProgressMonitor};
use socam_model::Model;
use socam_recording::{Dataset, Selection};

fn bench() -> Result<(Model, [Dataset; 4]), Box<dyn Error>> {
    Ok(include!("doc/axis.rs"))
}

/// Records when the last part of a diagnosis begins, which follows the last choice.
#[derive(Default)]
struct Follower {
    has_chosen: AtomicBool,
}

impl Observer for Follower {
    fn progress(&self, _: &Progress) {}

    fn stop(&self) -> bool {
        false
    }

    fn part(&self, name: &str, _: f64) {
        self.has_chosen.store(name.starts_with("held-out recordings"), Ordering::Relaxed);
    }
}

fn options() -> Options {
    Options { most_effects: 1, ..Options::default() }
}

fn diagnosed(held_out: HeldOut<'_>) -> Diagnosis {
    let (model, recordings) = bench().unwrap();
    diagnose(&model, &recordings[..3], held_out, &options()).unwrap().diagnosis
}

#[test]
fn held_out_data_are_read_only_after_the_last_choice() {
    let (model, [a, b, c, d]) = bench().unwrap();
    let (early, late) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let follower = Arc::new(Follower::default());
    let held_out = HeldOut::none().with("d", || {
        let count = if follower.has_chosen.load(Ordering::Relaxed) { &late } else { &early };
        count.fetch_add(1, Ordering::Relaxed);
        Ok::<_, DiagnoseError>(d)
    });
    let options = Options { progress: ProgressMonitor::by(follower.clone()), ..options() };
    let answer = diagnose(&model, &[a, b, c], held_out, &options).unwrap().diagnosis;
    assert_eq!((early.into_inner(), late.into_inner()), (0, 1));
    assert_eq!(answer.validation, Validation::Holdout);
    let names: Vec<&str> = answer.recordings.iter().map(|own| own.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "c", "d"]);
}

#[test]
fn a_refused_diagnosis_opens_nothing() {
    let (model, [a, ..]) = bench().unwrap();
    let still = Dataset::from_columns("still", a.channels().to_vec(), vec![0.0, 0.1], vec![vec![1.0; 2]; 2]);
    let opened = AtomicUsize::new(0);
    let held_out = HeldOut::none().with("d", || {
        opened.fetch_add(1, Ordering::Relaxed);
        Err::<Dataset, _>("opened")
    });
    assert!(diagnose(&model, &[still.unwrap()], held_out, &options()).is_err());
    assert_eq!(opened.into_inner(), 0);
}

#[test]
fn what_is_wrong_with_a_held_out_recording_costs_the_proof_alone() {
    let (_, [a, _, _, d]) = bench().unwrap();
    let proven = diagnosed(HeldOut::in_memory(std::slice::from_ref(&d)));
    assert_eq!(proven.held_out.as_ref().map(|own| own.outcome), Some(ProofOutcome::Holds));
    let short = Dataset::from_columns("short", d.channels().to_vec(), vec![0.0], vec![vec![1.0]; 2]).unwrap();
    let lacking =
        Dataset::from_columns("lacking", d.channels()[..1].to_vec(), vec![0.0], vec![vec![1.0]]).unwrap();
    let copy = a.with_name("copy");
    let open = |data: &Dataset| {
        let data = data.clone();
        HeldOut::none().with(data.name().to_owned(), move || Ok::<_, DiagnoseError>(data))
    };
    let cases = [
        (HeldOut::none().with("absent", || Err::<Dataset, _>("there is no such file")), "no such file"),
        (open(&copy), "`copy` holds the same samples as `a`"),
        (open(&short), "short"),
        (open(&lacking), "speed"),
    ];
    for (held_out, words) in cases {
        let answer = diagnosed(held_out);
        let outcome = answer.held_out.as_ref().map(|own| own.outcome);
        assert_eq!(
            (outcome, answer.validation),
            (Some(ProofOutcome::Unusable), Validation::LeaveOneOut),
            "{words}"
        );
        let warning =
            answer.warnings.iter().find(|own| own.starts_with("the held-out recordings prove nothing"));
        assert!(warning.is_some_and(|own| own.contains(words)), "{words}: {:?}", answer.warnings);
        // The choice is the same.
        assert_eq!(answer.findings.len(), proven.findings.len());
        assert_eq!(answer.findings[0].parameters, proven.findings[0].parameters);
    }
}

#[test]
fn samples_that_are_fitted_are_refused_before_the_fit() {
    let (model, [a, b, c, _]) = bench().unwrap();
    let copy = HeldOut::in_memory(&[b.clone().with_name("copy")]);
    let refused = diagnose(&model, &[a, b, c], copy, &options()).unwrap_err();
    assert!(refused.to_string().starts_with("`copy` holds the same samples as `b`"), "{refused}");

    let folder = tempfile::tempdir().unwrap();
    let [run, copy] = ["run.csv", "copy.csv"].map(|name| folder.path().join(name));
    std::fs::write(&run, "t_s,speed_m_s\n0,1.5\n0.1,1.6\n").unwrap();
    std::fs::copy(&run, &copy).unwrap();
    let part = |span: &str| Selection::parse(&format!("{}{span}", copy.display())).unwrap();
    let run = [Selection::whole(&run)];
    assert!(matches!(refuse_copies(&run, &[part("@0.05..")]), Err(DiagnoseError::SameSamples { .. })));
    assert!(refuse_copies(&[part("@0..0.1")], &[part("@0.1..")]).is_ok());
    assert!(refuse_copies(&run, &[Selection::whole(folder.path().join("absent.csv"))]).is_err());
}
