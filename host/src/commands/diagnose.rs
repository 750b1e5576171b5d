//! `diagnose`: missing physics of a model, with validation on held-out recordings.

mod text;

use std::path::{Path, PathBuf};

use socam_diagnose::Answer;
use socam_job::{Diagnose, Grid, HeldOutRecording, JobError, Settings};
use socam_recording::Steady;

use super::{ModelFile, Outcome};
use crate::interrupt::Interrupt;
use crate::{output, provenance, watch};
pub(crate) use text::text;

/// Find the physics that a model lacks, where it acts, and whether adding it improves predictions
///
/// Fits the model to the recordings, tests whether anything is missing, tries every effect of the catalogue at every place, and keeps those
/// that predict better in cross-validation (leave one recording out). Recordings of --holdout are read only after the last choice, for
/// validation; until then only their checksums are compared. Without them the result is not validated. After the time of --budget the
/// search ends, and what was found so far is the answer. Ctrl-C does the same, but writes no model (exit code 130); a second one ends at once.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host diagnose RUN1.mcap RUN2.mcap --holdout RUN3.mcap
  socam-host diagnose RUN*.mcap --report report --write-model corrected.toml
  socam-host diagnose POINTS.csv                 # steady states: a table whose first column is `point_1`")]
pub(crate) struct Args {
    #[arg(value_name = "RUN", required = true, help = output::RUNS_HELP)]
    runs: Vec<String>,
    /// Held-out recordings for validation, used in no fit and in no choice; may be repeated
    #[arg(long, value_name = "RUN")]
    holdout: Vec<String>,
    #[command(flatten)]
    task: Diagnose,
    /// Write the corrected model to this file, unless Ctrl-C ended the search
    #[arg(long, value_name = "FILE")]
    write_model: Option<PathBuf>,
    /// Replace the file of --write-model and the page of --report, if they exist
    #[arg(long)]
    force: bool,
    /// Write index.html, diagnosis.json and (unless Ctrl-C ended the search) model.toml into this directory
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

pub(crate) fn run(mut args: Args) -> anyhow::Result<Outcome> {
    args.runs = output::expanded(&args.runs)?;
    args.holdout = output::expanded(&args.holdout)?;
    args.task.validate()?;
    output::check_page(args.report.as_deref(), args.force)?;
    let model = args.task.model.load()?;
    let tables = args.task.are_tables(&args.runs, &args.holdout)?;
    let interrupt = Interrupt::listen();
    let target = args.write_model.as_deref().map(|path| ModelFile::create(path, args.force, &interrupt));
    let target = target.transpose()?;
    let (done, training) = if tables {
        let tables = args.runs.iter().map(table).collect::<Result<Vec<_>, _>>()?;
        (args.task.run_steady(model, &tables)?, Vec::new())
    } else {
        let training = output::open_all(Grid::Fit, &args.runs)?;
        let held_out = args.holdout.iter().cloned().map(HeldOutRecording::File).collect();
        let done = watch::fit(&interrupt, args.progress, |progress| {
            args.task.run(model, &training, held_out, progress)
        })?;
        done.held_out.iter().for_each(|data| output::say_warnings(data.name(), data));
        (done, training)
    };
    let Answer { diagnosis, evidence, model_toml } = &done.answer;
    let is_interrupted = diagnosis.is_interrupted();
    if let Some(target) = target {
        target.write(model_toml, is_interrupted)?;
    }
    if let Some(dir) = &args.report {
        let (name, model) = (&args.task.model.model, &done.model);
        let made = provenance::of(name, model, args.runs.iter().chain(&args.holdout))?;
        socam_report::diagnosis::write(dir, diagnosis, evidence, (model, Some(model_toml)), &made)?;
    }
    if args.json {
        output::print_json(diagnosis)?;
    } else {
        diagnosis.warnings.iter().for_each(output::warn);
        output::print(&text(diagnosis))?;
    }
    Ok(Outcome::on(training.iter().chain(&done.held_out)).unless_interrupted(is_interrupted))
}

fn table(run: &String) -> Result<Steady, JobError> {
    let table = Steady::open(Path::new(run))?;
    table.warnings.iter().for_each(|warning| output::warn(format_args!("`{run}`: {warning}")));
    Ok(table)
}
