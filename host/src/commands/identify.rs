//! `identify`: recordings and a model in, parameters with intervals out.

#[cfg(feature = "thesis")]
mod coefficient_match;
#[cfg(feature = "exchange")]
mod etf;
#[cfg(feature = "exchange")]
mod files;
mod frf;
mod result;

use std::path::PathBuf;

use socam_identify::End;
use socam_job::{Grid, Identify, Method, NOT_OVER_FREQUENCY, Settings, inputs};

#[cfg(not(all(feature = "exchange", feature = "thesis")))]
use super::not_built;
use super::{ModelFile, Outcome};
use crate::interrupt::Interrupt;
use crate::output::{self, WrongArguments};
use crate::watch;
use result::report;

/// Identify stiffness, damping and friction from recordings
///
/// Fits the free parameters of the model to all recordings together and prints each with its 95 % interval. For a parameter that the
/// recordings do not determine, a note says why, and combinations that are determined are printed. After the time of --budget the
/// search ends, and the best point so far is the result. Ctrl-C does the same, but writes no model (exit code 130); a second one ends at once.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host identify RUN1.mcap RUN2.mcap
  socam-host identify RUN.mcap --fix k3=52485 --write-model bench.toml
  socam-host identify train.csv --model emps --method inverse-dynamics --validate test.csv
  socam-host identify RUN1.csv RUN2.csv --model bench.toml --validate RUN3.csv --band 2..80
  socam-host identify RUN.mcap --method frf --report response
  socam-host identify RUN.mcap --method etf --orders 3/6 --stable --report transfer
  socam-host identify transfer/transfer.json --method coefficient-match")]
pub(crate) struct Args {
    #[arg(value_name = "RUN", required = true, help = output::RUNS_HELP)]
    runs: Vec<String>,
    /// Validation recordings, predicted with the result and not used in the fit; may be repeated
    #[arg(long, value_name = "RUN")]
    validate: Vec<String>,
    #[command(flatten)]
    task: Identify,
    /// Write the model with the identified values to this file, unless Ctrl-C ended the search
    #[arg(long, value_name = "FILE")]
    write_model: Option<PathBuf>,
    /// Replace the file of --write-model and the page of --report, if they exist
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of tables
    #[arg(long)]
    json: bool,
    /// Report progress on stderr even if it is not a terminal
    #[arg(long)]
    progress: bool,
    /// Write a page, its plots and its numbers into this folder
    #[arg(long, value_name = "DIR", help_heading = "Options of frf, etf and coefficient-match")]
    report: Option<PathBuf>,
}

pub(crate) fn run(mut args: Args) -> anyhow::Result<Outcome> {
    args.runs = output::expanded(&args.runs)?;
    args.validate = output::expanded(&args.validate)?;
    let model = args.task.model.load()?;
    let paths = inputs::paths(&args.runs)?;
    let model = args.task.calibrated(model, paths.iter().map(PathBuf::as_path))?;
    model.warnings.iter().for_each(output::warn);
    refuse_unused(&args)?;
    output::check_page(args.report.as_deref(), args.force)?;
    match args.task.method {
        Method::Frf => return frf::run(&args, &model.model),
        #[cfg(feature = "exchange")]
        Method::Etf => return etf::run(&args, &model.model),
        #[cfg(not(feature = "exchange"))]
        Method::Etf => return Err(not_built("`--method etf`", "exchange")),
        #[cfg(feature = "thesis")]
        Method::CoefficientMatch => return coefficient_match::run(&args, &model.model),
        #[cfg(not(feature = "thesis"))]
        Method::CoefficientMatch => return Err(not_built("`--method coefficient-match`", "thesis")),
        Method::OutputError | Method::InverseDynamics => {}
    }
    if args.task.band.is_some() && args.validate.is_empty() {
        let message = "--band needs --validate RUN with this method: it is the held-out fit that it bounds";
        return Err(WrongArguments(message.into()).into());
    }
    args.task.options(&model.model)?;
    let interrupt = Interrupt::listen();
    let target = args.write_model.as_deref().map(|path| ModelFile::create(path, args.force, &interrupt));
    let target = target.transpose()?;
    inputs::refuse_fitted(&args.runs, &args.validate)?;
    let grid = Grid::Fit;
    let (training, held_out) = (output::open_all(grid, &args.runs)?, output::open_all(grid, &args.validate)?);
    let done = watch::fit(&interrupt, args.progress, |progress| {
        args.task.run(&model, &training, &held_out, progress)
    })?;
    let is_interrupted = done.result.end == End::Interrupted;
    if let Some(target) = target {
        target.write(&done.model_text()?, is_interrupted)?;
    }
    if args.json {
        output::print_json(&done.document())?;
    } else {
        // What ended the search is the first line of the report.
        let others =
            done.result.warnings.iter().filter(|warning| Some(*warning) != done.result.unfinished.as_ref());
        others.for_each(output::warn);
        output::print(&report(done.document()))?;
    }
    Ok(Outcome::on(training.iter().chain(&held_out)).unless_interrupted(is_interrupted))
}

/// Refuses options that the method does not use.
fn refuse_unused(args: &Args) -> anyhow::Result<()> {
    args.task.validate()?;
    if args.task.method.is_over_time() {
        if args.report.is_some() {
            let message = "--report belongs to the methods over frequency (frf, etf, coefficient-match); this method's results are written by --json and --write-model, and `diagnose --report` draws measured against predicted";
            return Err(WrongArguments(message.into()).into());
        }
        return Ok(());
    }
    let unused = [("--validate", !args.validate.is_empty()), ("--write-model", args.write_model.is_some())];
    match unused.iter().find(|(_, given)| *given) {
        Some((option, _)) => Err(WrongArguments(format!("{option}{NOT_OVER_FREQUENCY}")).into()),
        None => Ok(()),
    }
}
