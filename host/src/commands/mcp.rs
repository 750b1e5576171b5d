//! `mcp`: the commands as tools for agents.

use std::path::PathBuf;

use anyhow::Context;
use socam_mcp::Settings;

use super::Outcome;
use crate::output::WrongArguments;

/// Offer the commands as tools to an agent, by the Model Context Protocol over stdin and stdout
///
/// An agent (or any client of the protocol) starts this command and calls its tools: info, check, identify, diagnose, compare, simulate,
/// design and others, with the options of the commands. Without --write no tool writes a file.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host mcp                    what a client's settings have as the command of a server
  socam-host mcp --write results    models, reports and recordings may be written into this folder")]
pub(crate) struct Args {
    /// Folder into which tools may write new files; nothing is replaced
    #[arg(long, value_name = "DIR")]
    write: Option<PathBuf>,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let folder = args.write.map(|folder| {
        if !folder.is_dir() {
            let problem = format!("--write {}: there is no such folder; make it first", folder.display());
            return Err(anyhow::Error::from(WrongArguments(problem)));
        }
        folder.canonicalize().with_context(|| format!("cannot open `{}`", folder.display()))
    });
    let program = std::env::current_exe().context("cannot find this program's own file")?;
    let settings = Settings { program, folder: folder.transpose()?, has_pictures: cfg!(feature = "window") };
    socam_mcp::serve(settings)?;
    Ok(Outcome::Done)
}
