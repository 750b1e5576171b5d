//! `export`: any recording to CSV.

use std::io;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use socam_recording::{Format, Selection, export_csv, write_csv};

use super::Outcome;
use crate::output::{self, WrongArguments};

/// Turn a recording into a .csv table
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Recording (.mcap, .csv or .m), or a part of it: RUN@FROM..TO in seconds
    #[arg(value_name = "RUN")]
    run: String,
    /// File to write, `-` for stdout; beside RUN with the extension .csv when not given
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Format to write
    #[arg(long, value_enum, default_value_t = Target::Csv)]
    format: Target,
}

/// Formats that can be named; only one is there yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Target {
    Csv,
    #[value(hide = true)]
    Parquet,
    #[value(hide = true)]
    Mat,
}

/// Writes the table. What a log has lost is lost in the table too, and said by the outcome.
pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let extension = args.output.as_deref().and_then(Path::extension);
    if args.format != Target::Csv || extension.is_some_and(|e| e == "parquet" || e == "mat") {
        return Err(WrongArguments(
            "export writes .csv only; Parquet and .mat are not there yet (both read .csv)".into(),
        )
        .into());
    }
    let selection = Selection::parse(&args.run)?;
    let data = output::open(&args.run)?;
    let target = match args.output {
        Some(target) => target,
        None if data.format() == Format::Csv => {
            return Err(WrongArguments(format!(
                "`{}` is a .csv already; name the file to write with -o",
                args.run
            ))
            .into());
        }
        None => selection.path.with_extension("csv"),
    };
    let outcome =
        if data.cut().is_some() || data.lost_samples() > 0 { Outcome::LostSamples } else { Outcome::Done };
    if target.as_os_str() == "-" {
        write_csv(&data, &mut io::stdout().lock(), Path::new("stdout"))?;
        return Ok(outcome);
    }
    export_csv(&data, &target)?;
    output::say(format_args!(
        "{} rows of {} channels written to {}",
        data.rows(),
        data.channels().len(),
        target.display()
    ));
    Ok(outcome)
}
