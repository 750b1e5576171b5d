//! `completions`: completion scripts for shells.

use clap::CommandFactory;
use clap_complete::Shell;

use super::Outcome;
use crate::{cli::Cli, output};

/// Print a completion script for a shell
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host completions bash > ~/.local/share/bash-completion/completions/socam-host
  socam-host completions fish > ~/.config/fish/completions/socam-host.fish")]
pub(crate) struct Args {
    /// Shell of the script
    shell: Shell,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "socam-host", &mut script);
    output::print(&String::from_utf8(script)?)?;
    Ok(Outcome::Done)
}
