//! One recording through the cascade: read, check, score test, and the full diagnosis where something stands out.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use socam_diagnose::{DiagnoseError, Frozen, HeldOut, screen};
use socam_job::Grid;
use socam_model::Model;
use socam_recording::{
    Dataset, Selection,
    check::{Severity, check},
};

use crate::fill;
use crate::labels;
use crate::options::FleetOptions;
use crate::row::{Row, Stage, Status, Verdict, finite};
use crate::source::{Source, VERSION};

/// Why a row ends before its verdict.
struct End {
    status: Status,
    message: String,
}

impl End {
    fn new(status: Status, problem: impl std::fmt::Display) -> Self {
        Self { status, message: problem.to_string() }
    }
}

/// Diagnoses one recording. Everything that can go wrong with it, panics included, is a row that says so. The computation takes one thread,
/// and the same arguments give the same row.
#[must_use]
pub fn diagnose_one(source: &Source, model: &Model, options: &FleetOptions, seed: u64) -> Row {
    let mut row = empty(source, model);
    match source.id(model, options, seed) {
        Ok(id) => row.id = id,
        Err(error) => {
            row.id = source.id_of_name(model, options, seed);
            (row.status, row.message) = (Status::Unreadable, format!("the file cannot be read: {error}"));
            return row;
        }
    }
    let cascade = |path: &Path| {
        let end = on_one_thread(|| run(source, path, (model, options, seed), &mut row));
        if let Err(End { status, message }) = end {
            (row.status, row.message) = (status, message);
        }
        // Errors name the file; its place on this computer is not part of the row.
        let place = path.display().to_string();
        let texts = std::iter::once(&mut row.message).chain(&mut row.warnings);
        texts.for_each(|text| *text = text.replace(&place, &source.name));
    };
    if let Err(error) = source.with_path(cascade) {
        (row.status, row.message) =
            (Status::Failed, format!("there is no room for a temporary file: {error}"));
    }
    row
}

/// The row of a recording of which only the name is known.
fn empty(source: &Source, model: &Model) -> Row {
    Row {
        id: String::new(),
        recording: source.name.clone(),
        machine: source.machine.clone().or_else(|| labels::machine_of_name(&source.name)),
        date: source.date.or_else(|| labels::date_of_name(&source.name)),
        status: Status::Ok,
        message: String::new(),
        stage: Stage::Read,
        verdict: None,
        p_value: None,
        excess: None,
        samples: None,
        duration_s: None,
        findings: Vec::new(),
        parameters: Vec::new(),
        channels: Vec::new(),
        warnings: Vec::new(),
        model: model.name.clone(),
        version: VERSION.into(),
    }
}

/// Runs `work` on a thread pool of one thread, so that its parallel loops take no other, and turns a panic into an end.
fn on_one_thread(work: impl FnOnce() -> Result<(), End> + Send) -> Result<(), End> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool =
        pool.map_err(|error| End::new(Status::Failed, format!("there is no thread for it: {error}")))?;
    let outcome = catch_unwind(AssertUnwindSafe(|| pool.install(work)));
    outcome.unwrap_or_else(|panic| Err(End::new(Status::Failed, panicked(&*panic))))
}

fn panicked(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    format!("a defect of this program ended the computation: {text}; please report it with the recording")
}

/// The cascade. What was found before an end stays in the row.
fn run(
    source: &Source,
    path: &Path,
    (model, options, seed): (&Model, &FleetOptions, u64),
    row: &mut Row,
) -> Result<(), End> {
    let opened = socam_import::open_selection(&Selection::whole(path));
    let data = opened.map_err(|error| End::new(Status::Unreadable, error))?;
    let data = Grid::Fit.apply(data);
    let data = data.map_err(|error| End::new(Status::Unreadable, error))?;
    row.machine = source.machine.clone().or_else(|| labels::machine_of_log(&data)).or(row.machine.take());
    row.date = source.date.or_else(|| labels::date_of_log(&data)).or(row.date);
    row.samples = Some(data.rows());
    row.duration_s = finite(data.end_s() - data.start_s());
    row.warnings.extend(data.warnings().iter().map(ToString::to_string));
    row.stage = Stage::Check;
    checked(&data, model, options, row)?;
    row.stage = Stage::ScoreTest;
    let unfit = |error: DiagnoseError| End::new(Status::Unfit, error);
    let settings = options.diagnosis(seed);
    let own;
    let frozen = match &options.frozen {
        Some(frozen) => frozen,
        None => {
            own = Frozen::of(model, &data, &settings).map_err(unfit)?;
            &own
        }
    };
    let screening = match screen(model, &data, frozen, &settings) {
        Ok(screening) => Some(screening),
        // A machine may be too far from the frozen values for one descent.
        Err(DiagnoseError::Diverged { .. }) => None,
        Err(error) => return Err(unfit(error)),
    };
    if let Some(screening) = &screening {
        fill::screening(screening, model, row);
        if screening.p_value >= options.false_alarm_rate {
            row.verdict = Some(Verdict::Adequate);
            return Ok(());
        }
    }
    row.stage = Stage::Diagnosis;
    let answer = socam_diagnose::diagnose(model, std::slice::from_ref(&data), HeldOut::none(), &settings);
    fill::diagnosis(&answer.map_err(unfit)?.diagnosis, row);
    Ok(())
}

/// Refuses a recording that the check calls unfit; reservations are warnings.
fn checked(data: &Dataset, model: &Model, options: &FleetOptions, row: &mut Row) -> Result<(), End> {
    let expected = socam_requirements::of_model(model, options.ratio_tolerance);
    let found = check(data, &expected).map_err(|error| End::new(Status::Unreadable, error))?;
    let of = |severity| found.findings.iter().filter(move |finding| finding.severity() == severity);
    row.warnings.extend(of(Severity::Weakens).map(|finding| finding.sentence()));
    let preventing: Vec<String> = of(Severity::Prevents).map(|finding| finding.sentence()).collect();
    if preventing.is_empty() { Ok(()) } else { Err(End::new(Status::Unfit, preventing.join("; "))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_row_that_says_so() {
        let end = on_one_thread(|| {
            assert_eq!(rayon::current_num_threads(), 1);
            panic!("index 7 of {}", 3)
        });
        let End { status, message } = end.unwrap_err();
        assert!(status == Status::Failed && message.contains("index 7 of 3"), "{message}");
        assert!(on_one_thread(|| Ok(())).is_ok());
    }

    #[test]
    fn what_cannot_be_read_is_a_row_that_names_the_recording_and_no_place() {
        let model = Model::builtin("two-mass").unwrap();
        let options = FleetOptions::default();
        let of = |source: &Source| diagnose_one(source, &model, &options, 1);
        let absent = of(&Source::path("/nowhere/SN1/run.csv"));
        assert_eq!((absent.status, absent.stage, absent.id.len()), (Status::Unreadable, Stage::Read, 64));
        let folder = of(&Source::path("/"));
        assert!(folder.message.contains("it is not a file"), "{}", folder.message);
        let noise = of(&Source::bytes("SN2/2026-01-02/noise.mcap", vec![7; 1000]));
        assert_eq!((noise.status, noise.machine.as_deref()), (Status::Unreadable, Some("SN2")));
        assert!(noise.message.contains("`SN2/2026-01-02/noise.mcap`"), "{}", noise.message);
        // Channels of another bench.
        let other = of(&Source::bytes("a.csv", b"t_s,position_m\n0,1\n1,2\n2,1\n".to_vec()));
        assert_eq!((other.status, other.stage), (Status::Unfit, Stage::Check), "{}", other.message);
    }
}
