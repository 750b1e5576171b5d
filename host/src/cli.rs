//! The command line as it is typed.

use clap::Parser;

use crate::commands::Command;

/// From recordings of a drivetrain bench to a model one can trust
#[derive(Debug, Parser)]
#[command(name = "socam-host", version, max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}
