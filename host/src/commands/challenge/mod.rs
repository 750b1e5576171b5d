//! `challenge`: concealed physics, diagnosed and scored.

mod answer;
mod background;
mod crew;
mod files;
mod oracle;
mod probability;
mod rates;
mod report;
mod score;

use std::path::PathBuf;

use socam_diagnose::Diagnosis;
use socam_diagnose::document::Finding;
use socam_model::Model;
use socam_recording::Dataset;
use socam_sim::challenge::{Case, CaseKind, FAMILY_NAMES, Recordings, family_of};

use super::Outcome;
use crate::output;
use files::{File, Folder};
use report::Report;
use score::Score;

/// Hide physics in random machines, diagnose their recordings, and count how often the answer is right
///
/// Each case is drawn from the seed and its number. Of twenty cases, eight hide nothing, seven hide one effect of the catalogue, three hide
/// two, and two hide an effect that is not in the catalogue. Machines are of nine families; the start values of their models are wrong by up
/// to a factor of three. Hidden effects obey other equations than the fitted ones. Cases with odd numbers are realistic: they have further
/// unmodelled background effects, and are scored separately. The truth is sealed in a file before the diagnosis begins and opened once its
/// answer is on disk.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host challenge
  socam-host challenge --cases 0..100 --seed 101 --resume challenge
  socam-host challenge --cases 0..1000 --clean --resume challenge
  socam-host challenge --cases 0..200 --family link --json
  socam-host challenge --cases 5..6 --resume challenge --recordings      into challenge/seed-1-case-00005")]
pub(crate) struct Args {
    /// Range of case numbers, FROM..TO; TO is excluded
    #[arg(long, value_name = "A..B", default_value = "0..20", value_parser = range)]
    cases: std::ops::Range<u64>,
    /// Seed of the cases
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Keep truths, answers and scores in this folder, and skip cases that are finished there
    #[arg(long, value_name = "DIR")]
    resume: Option<PathBuf>,
    /// Also keep each case's base model and recordings in a folder of its own, for a diagnosis by hand
    #[arg(long, requires = "resume")]
    recordings: bool,
    /// Only machines of this family
    #[arg(long, value_name = "NAME", value_parser = FAMILY_NAMES)]
    family: Option<String>,
    /// Only benches with nothing hidden, to measure the false alarm rate
    #[arg(long)]
    clean: bool,
    /// Number of threads [default: number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    json: bool,
}

/// `A..B`
fn range(text: &str) -> Result<std::ops::Range<u64>, String> {
    let wrong = || format!("`{text}` is no range of cases; expected A..B, as in 0..20");
    let (from, to) = text.split_once("..").ok_or_else(wrong)?;
    let (from, to): (u64, u64) = (from.parse().map_err(|_| wrong())?, to.parse().map_err(|_| wrong())?);
    if from < to { Ok(from..to) } else { Err(wrong()) }
}

/// The diagnosis under test, a function of base model, training recordings and held-out recordings.
type Diagnose<'a> = dyn Fn(&Model, &[Dataset], &[Dataset]) -> Result<Diagnosis, String> + Sync + 'a;

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let temporary = if args.resume.is_none() { Some(tempfile::tempdir()?) } else { None };
    let path = args.resume.as_deref().or(temporary.as_ref().map(tempfile::TempDir::path));
    let folder = Folder::open(path.unwrap_or(std::path::Path::new(".")))?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = args.threads.map_or(cores, usize::from);
    let (scores, failures) = score_all(&args, threads, &folder, &diagnose)?;
    let report = Report::new(args.seed, scores);
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text())?;
    }
    if let Some((number, first)) = failures.first() {
        anyhow::bail!("{} cases came to nothing; the first is case {number}: {first:#}", failures.len());
    }
    Ok(Outcome::Done)
}

/// The diagnosis of this program.
fn diagnose(model: &Model, training: &[Dataset], holdout: &[Dataset]) -> Result<Diagnosis, String> {
    let held_out = socam_diagnose::HeldOut::in_memory(holdout);
    let answer = socam_diagnose::diagnose(model, training, held_out, &socam_diagnose::Options::default());
    answer.map(|answer| answer.diagnosis).map_err(|error| error.to_string())
}

type Failures = Vec<(u64, anyhow::Error)>;

fn score_all(
    args: &Args,
    threads: usize,
    folder: &Folder,
    diagnose: &Diagnose<'_>,
) -> anyhow::Result<(Vec<Score>, Failures)> {
    let mut wanted = Vec::new();
    for number in args.cases.clone() {
        let is_of_family =
            || args.family.as_ref().is_none_or(|family| *family == family_of(args.seed, number));
        if (!args.clean || CaseKind::of(number) == CaseKind::Clean) && is_of_family() {
            wanted.push(number);
        }
    }
    let answers = crew::run(&wanted, threads, |number| one(args, *number, folder, diagnose))?;
    let (mut scores, mut failures) = (Vec::new(), Vec::new());
    for (number, answer) in wanted.into_iter().zip(answers) {
        match answer {
            Ok(score) => scores.push(score),
            Err(error) => failures.push((number, error)),
        }
    }
    Ok((scores, failures))
}

/// Draws, diagnoses and scores one case, unless it is finished.
fn one(args: &Args, number: u64, folder: &Folder, diagnose: &Diagnose<'_>) -> anyhow::Result<Score> {
    let seed = args.seed;
    let finished = folder.read::<Score>(seed, number, File::Score).ok();
    if let Some(finished) = finished.filter(|finished| finished.schema == score::SCHEMA) {
        if args.recordings {
            let case: Case = folder.read(seed, number, File::Sealed)?;
            folder.keep(&case, &case.record()?)?;
        }
        return Ok(finished);
    }
    let (model, recordings) = conceal(args, number, folder)?;
    let (answer, cpu_s) =
        answered(seed, number, folder, || diagnose(&model, &recordings.training, &recordings.holdout))?;
    let case: Case = folder.read(seed, number, File::Sealed)?;
    let equivalent = |finding: &Finding, index: usize| {
        let named = (finding.effect.as_str(), finding.location.as_str(), &*oracle::values(finding));
        oracle::is_equivalent(&case, &recordings, index, named)
    };
    let mut score = Score::new(&case, (&answer, cpu_s), oracle::ask(&case, &recordings), &equivalent);
    // The catalogue has no law for what lies outside it, so that there is no truth to put in.
    if let (false, Ok(answer), true) = (score.right, &answer, case.kind != CaseKind::Outside) {
        score.truth_gains = oracle::truth_gains(&case, &recordings, &answer.findings);
    }
    folder.write(seed, number, File::Score, &score)?;
    Ok(score)
}

/// The answer in the folder, with its processor time in s. If there is none, diagnoses the case and writes the answer there.
fn answered(
    seed: u64,
    number: u64,
    folder: &Folder,
    diagnose: impl FnOnce() -> Result<Diagnosis, String>,
) -> anyhow::Result<(Result<Diagnosis, String>, f64)> {
    if let Ok(known) = folder.read::<Diagnosis>(seed, number, File::Diagnosis) {
        let cpu_s = known.cpu_s;
        return Ok((Ok(known), cpu_s));
    }
    // One thread processes a case from beginning to end.
    let clock = cpu_time::ThreadTime::now();
    let answer = diagnose();
    let cpu_s = clock.elapsed().as_secs_f64();
    match &answer {
        Ok(diagnosis) => folder.write(seed, number, File::Diagnosis, diagnosis)?,
        Err(error) => folder.write(seed, number, File::Diagnosis, error)?,
    }
    Ok((answer, cpu_s))
}

/// Draws a case, seals its truth, and returns the data that a diagnosis may see.
fn conceal(args: &Args, number: u64, folder: &Folder) -> anyhow::Result<(Model, Recordings)> {
    let case = Case::draw(args.seed, number)?;
    folder.write(args.seed, number, File::Sealed, &case)?;
    let recordings = case.record()?;
    if args.recordings {
        folder.keep(&case, &recordings)?;
    }
    Ok((case.base()?, recordings))
}

#[cfg(test)]
mod tests;
