//! `recover`: a clean log from a damaged one.

use std::path::PathBuf;

use socam_recording::recover;

use super::Outcome;
use crate::output;

/// Write all that can be read of a damaged or cut log into a new one
///
/// The new log has a new index, and a note of what is missing. The old one is not changed. Exit code 3 says that samples are missing.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host recover broken.mcap whole.mcap")]
pub(crate) struct Args {
    /// Damaged log (.mcap)
    #[arg(value_name = "IN.mcap")]
    source: PathBuf,
    /// Log to write (.mcap)
    #[arg(value_name = "OUT.mcap")]
    target: PathBuf,
    /// Replace an existing log
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    output::check_target(&args.target, &args.source, args.force)?;
    let recovered = recover(&args.source, &args.target)?;
    for warning in &recovered.missing {
        output::warn(format_args!("`{}`: {warning}", args.source.display()));
    }
    output::say(format_args!("{} samples written to {}", recovered.samples, args.target.display()));
    Ok(if recovered.missing.is_empty() && recovered.lost == 0 { Outcome::Done } else { Outcome::LostSamples })
}
