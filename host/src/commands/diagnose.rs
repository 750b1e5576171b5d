//! `diagnose`: missing physics of a model, with validation on held-out recordings.

mod steady;
mod text;

use std::io::Write;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use socam_diagnose::{Answer, HeldOut};
use socam_recording::{Dataset, OutputFile, RecordingError, Selection};

use super::{Outcome, identify::Start};
use crate::interrupt::Interrupt;
use crate::output::{self, WrongArguments};
use crate::{model_file, provenance, watch};
pub(crate) use text::text;

/// Find the physics that a model lacks, where it acts, and whether adding it improves predictions
///
/// Fits the model to the recordings, tests whether anything is missing, tries every effect of the catalogue at every place, and keeps those
/// that predict better in cross-validation (leave one recording out). Recordings of --holdout are read only after the last choice, for
/// validation; until then only their checksums are compared. Without them the result is not validated.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host diagnose RUN1.mcap RUN2.mcap --holdout RUN3.mcap
  socam-host diagnose RUN*.mcap --report report --write-model corrected.toml
  socam-host diagnose POINTS.csv                 # steady states: a table whose first column is `point_1`")]
pub(crate) struct Args {
    /// Recordings (.mcap, .csv, legacy .m), or parts of them: RUN@FROM..TO in seconds
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    /// Held-out recordings for validation, used in no fit and in no choice; may be repeated
    #[arg(long, value_name = "RUN")]
    holdout: Vec<String>,
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = model_file::HELP)]
    model: String,
    /// Fix a parameter at its value in the model or at the given value (SI); may be repeated
    #[arg(long, value_name = "NAME[=VALUE]")]
    fix: Vec<String>,
    /// False alarm rate, 0 to 1: share of complete models for which something may be found
    #[arg(long, value_name = "P", default_value_t = 0.01)]
    false_alarm_rate: f64,
    /// For steady states: relative standard deviation of repeated readings at one operating point [default: 0.002]
    #[arg(long, value_name = "SHARE")]
    repeatability: Option<f64>,
    /// Start state of each recording
    #[arg(long, value_enum, default_value = "free")]
    start: Start,
    /// Materiality, a fraction of a channel's standard deviation: findings that change every prediction by less are listed but do not count
    /// as missing physics
    #[arg(long, value_name = "SHARE", default_value_t = 0.001)]
    tolerance: f64,
    #[arg(long, value_name = "[INPUT=]KIND", help = model_file::BETWEEN_HELP)]
    between: Vec<String>,
    /// Greatest number of effects to add
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=6))]
    most: u8,
    /// Seed of the random start values
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write the corrected model to this file
    #[arg(long, value_name = "FILE")]
    write_model: Option<PathBuf>,
    /// Replace the file of --write-model, if it exists
    #[arg(long)]
    force: bool,
    /// Write index.html, diagnosis.json and model.toml into this directory
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    json: bool,
    /// Report progress on stderr even if it is not a terminal
    #[arg(long)]
    progress: bool,
}

/// Diagnoses one recording with all other options at their defaults, and prints the result as text.
pub(super) fn of_one(recording: &str, model: &str) -> anyhow::Result<Outcome> {
    #[derive(clap::Parser)]
    struct Alone {
        #[command(flatten)]
        args: Args,
    }
    let alone = <Alone as clap::Parser>::try_parse_from(["diagnose", recording, "--model", model])?;
    run(alone.args)
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let mut model = model_file::load(&args.model)?;
    model_file::set(&mut model, &args.fix, true)?;
    model_file::set_between(&mut model, &args.between)?;
    if !(args.false_alarm_rate > 0.0 && args.false_alarm_rate < 1.0) {
        let message =
            format!("--false-alarm-rate {}: expected a number between 0 and 1", args.false_alarm_rate);
        return Err(WrongArguments(message).into());
    }
    apart(&args)?;
    if steady::are_named(&args)? {
        return steady::run(&args, &model);
    }
    let interrupt = Interrupt::listen();
    let target = args.write_model.as_deref().map(|path| output::create_new(path, args.force)).transpose()?;
    interrupt.unfinished(target.as_ref().and_then(OutputFile::temporary));
    // Outputs that are missing at most grid points would have no spectra.
    let training: anyhow::Result<Vec<Dataset>> =
        args.runs.iter().map(|run| output::open_for(run, &model, 1)).collect();
    let training = training?;
    check_held_out(&args)?;
    let opened = Mutex::new(Vec::new());
    let open = |run: &str| {
        let data = output::open_silently(run, &model, 1)?;
        opened.lock().unwrap_or_else(PoisonError::into_inner).push(data.clone());
        anyhow::Ok(data)
    };
    let held_out = args.holdout.iter().fold(HeldOut::none(), |all, run| all.with(run, move || open(run)));
    let mut fit = socam_identify::Options::default();
    let answer = watch::fit(&interrupt, args.progress, &mut fit, |fit| {
        let options = socam_diagnose::Options {
            false_alarm_rate: args.false_alarm_rate,
            most_effects: args.most.into(),
            tolerance: args.tolerance,
            seed: args.seed,
            start_state: args.start.state(),
            watch: fit.watch.clone(),
            ..socam_diagnose::Options::default()
        };
        socam_diagnose::diagnose(&model, &training, held_out, &options)
    })?;
    let held_out = opened.into_inner().unwrap_or_else(PoisonError::into_inner);
    held_out.iter().for_each(|data| output::say_warnings(data.name(), data));
    if let Some(mut target) = target {
        target.write_all(answer.model_toml.as_bytes())?;
        target.commit()?;
        interrupt.unfinished(None);
    }
    let Answer { diagnosis, evidence, model_toml } = &answer;
    if let Some(dir) = &args.report {
        let made = provenance::of(&args.model, &model, args.runs.iter().chain(&args.holdout))?;
        socam_report::diagnosis::write(dir, diagnosis, evidence, (&model, Some(model_toml)), &made)?;
    }
    if args.json {
        output::print_json(diagnosis)?;
    } else {
        diagnosis.warnings.iter().for_each(output::warn);
        output::print(&text(diagnosis))?;
    }
    Ok(Outcome::on(training.iter().chain(&held_out)))
}

/// Refuses held-out recordings that cannot be opened, as far as their first bytes tell, and copies of fitted files. Reads no sample: that is
/// left to the diagnosis, after its last choice.
fn check_held_out(args: &Args) -> anyhow::Result<()> {
    let selections = |runs: &[String]| {
        runs.iter().map(|run| Selection::parse(run)).collect::<Result<Vec<_>, RecordingError>>()
    };
    let held_out = selections(&args.holdout)?;
    held_out.iter().try_for_each(socam_import::probe)?;
    Ok(socam_diagnose::refuse_copies(&selections(&args.runs)?, &held_out)?)
}

/// Refuses samples that are named twice, also by different paths.
fn apart(args: &Args) -> anyhow::Result<()> {
    let mut known: Vec<(&String, Selection)> = Vec::new();
    for run in args.runs.iter().chain(&args.holdout) {
        let mut own = Selection::parse(run)?;
        own.path = own.path.canonicalize().unwrap_or(own.path);
        let overlaps = |other: &Selection| own.path == other.path && own.span.overlaps(&other.span);
        if let Some((before, _)) = known.iter().find(|(_, other)| overlaps(other)) {
            let what = if *before == run {
                format!("`{run}` is named twice")
            } else {
                format!("`{before}` and `{run}` have samples in common, which are named twice")
            };
            let message = format!("{what}; what is held out must not be fitted, and nothing counts double");
            return Err(WrongArguments(message).into());
        }
        known.push((run, own));
    }
    Ok(())
}
