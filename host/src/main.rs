//! `socam-host`: records a drivetrain bench, identifies it, and says where and why simulation and recording differ.
//!
//! Results go to stdout, messages to stderr. Exit codes: 0 done; 1 failed; 2 wrong arguments; 3 done, but samples were lost, or a recording
//! is damaged or cut off; 130 interrupted, as shells report it for any program. An answer that `--budget` ended is an answer: 0. The first
//! Ctrl-C ends a search, whose best answer so far is printed, without a model; a second one ends the program at once, without an answer.

mod alarms;
mod calibrated;
mod cli;
mod commands;
mod device;
mod interrupt;
mod live_watch;
mod output;
mod provenance;
mod rules;
mod serve;
mod table;
mod uf2;
mod watch;

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
