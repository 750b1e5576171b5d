//! `export`: any recording to CSV.

use std::io;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use socam_recording::{Format, Selection, export_csv, write_csv};

use super::Outcome;
use crate::output::{self, WrongArguments};

/// Turn recordings into .csv tables
///
/// The header is `t_s` (seconds) and one column per channel, its name ending in its unit: motor_speed_rad_s, torque_in_Nm. All
/// values are SI; an empty cell is a missing value.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host export run.mcap                       writes run.csv
  socam-host export run.mcap@2..10 -o part.csv     only from 2 s to 10 s
  socam-host export run.mcap -o - | head")]
pub(crate) struct Args {
    #[arg(value_name = "RUN", required = true, help = output::RUNS_HELP)]
    runs: Vec<String>,
    /// File to write, for a single RUN; `-` for stdout [default: beside RUN, with the extension .csv]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
    /// Format to write
    #[arg(long, value_enum, default_value_t = Target::Csv)]
    format: Target,
}

/// Formats; there is only one so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Target {
    Csv,
    #[value(hide = true)]
    Parquet,
    #[value(hide = true)]
    Mat,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let extension = args.output.as_deref().and_then(Path::extension);
    if args.format != Target::Csv || extension.is_some_and(|e| e == "parquet" || e == "mat") {
        let problem = "export writes .csv only; Parquet and .mat are not there yet (both read .csv)";
        return Err(WrongArguments(problem.into()).into());
    }
    if let (Some(output), Some(extension)) = (&args.output, extension.filter(|e| *e == "mcap" || *e == "m")) {
        let (path, extension) = (output.display(), extension.display());
        let problem = format!("`{path}`: export writes .csv, not .{extension} (`import` writes .mcap)");
        return Err(WrongArguments(problem).into());
    }
    let runs = output::expanded(&args.runs)?;
    output::single_output(&runs, args.output.as_deref())?;
    let mut outcome = Outcome::Done;
    for run in &runs {
        if export(run, args.output.as_deref(), args.force)? == Outcome::LostSamples {
            outcome = Outcome::LostSamples;
        }
    }
    Ok(outcome)
}

/// Writes one table. The outcome says whether the log has lost samples.
fn export(run: &str, output: Option<&Path>, replace: bool) -> anyhow::Result<Outcome> {
    let selection = Selection::parse(run)?;
    let data = output::open(run)?;
    let target = match output {
        Some(target) => target.to_owned(),
        None if data.format() == Format::Csv => {
            let problem = format!("`{run}` is a .csv already; name the file to write with -o");
            return Err(WrongArguments(problem).into());
        }
        None => selection.path.with_extension("csv"),
    };
    let outcome = Outcome::on([&data]);
    if target.as_os_str() == "-" {
        write_csv(&data, &mut io::stdout().lock(), Path::new("stdout"))?;
        return Ok(outcome);
    }
    output::check_target_of(&target, &selection, replace)?;
    export_csv(&data, &target)?;
    output::say(format_args!(
        "{} rows of {} channels written to {}",
        data.rows(),
        data.channels().len(),
        target.display()
    ));
    Ok(outcome)
}
