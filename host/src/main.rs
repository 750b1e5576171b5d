//! `socam-host`: records a drivetrain bench, identifies it, and says where and why simulation and recording differ.
//!
//! Results go to stdout, talk to stderr. Exit codes: 0 done; 1 failed; 2 wrong arguments; 3 done, but samples were lost.

mod cli;
mod commands;
mod device;
mod model_file;
mod output;
mod table;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    match cli.command.run() {
        Ok(outcome) => outcome.into(),
        Err(error) => output::report(&error),
    }
}
