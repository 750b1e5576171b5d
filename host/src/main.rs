//! `socam-host`: records a drivetrain bench, identifies it, and says where and why simulation and recording differ.
//!
//! Results go to stdout, talk to stderr. Exit codes: 0 done; 1 failed; 2 wrong arguments; 3 done, but samples were lost.

mod cli;
mod commands;
mod device;
mod expectation;
mod model_file;
mod output;
mod table;

use std::process::ExitCode;

fn main() -> ExitCode {
    let command = match cli::read() {
        Ok(command) => command,
        Err(code) => return code,
    };
    match command.run() {
        Ok(outcome) => outcome.into(),
        Err(error) => output::report(&error),
    }
}
