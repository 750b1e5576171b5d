//! `info`: contents of recordings.

mod contents;
mod text;

use std::path::PathBuf;

use serde::Serialize;

use super::Outcome;
use crate::output;
use contents::{Info, info};

/// Show the contents of recordings: channels, rates, gaps, lost samples, notes and missing values
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host info run.mcap
  socam-host info run.csv@2..10          only from 2 s to 10 s
  socam-host info --json *.mcap")]
pub(crate) struct Args {
    #[arg(value_name = "RUN", required = true, help = output::RUNS_HELP)]
    runs: Vec<String>,
    /// DBC that says what the frames of a CAN bus hold (candump, ASC, BLF) [default: the only one beside RUN]
    #[arg(long, value_name = "FILE.dbc")]
    dbc: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(mut args: Args) -> anyhow::Result<Outcome> {
    args.runs = output::expanded(&args.runs)?;
    let infos =
        args.runs.iter().map(|run| info(run, args.dbc.as_deref())).collect::<anyhow::Result<Vec<_>>>()?;
    if args.json {
        output::print_json(&Document { schema: "socam.info/1", recordings: &infos })?;
    } else {
        let texts: Vec<String> = infos.iter().map(Info::to_text).collect();
        output::print(&texts.join("\n"))?;
    }
    let all_complete = infos.iter().all(|info| info.is_complete);
    Ok(if all_complete { Outcome::Done } else { Outcome::LostSamples })
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    recordings: &'a [Info],
}
