//! `socam-host`: records a drivetrain bench, identifies it, and says where and why simulation and recording differ.
//!
//! Results go to stdout, messages to stderr. Exit codes: 0 done; 1 failed; 2 wrong arguments; 3 done, but samples were lost, or a recording
//! is damaged or cut off; 4 done with the best answer so far, because `--budget` or Ctrl-C ended the search. A second Ctrl-C ends a fit at once,
//! without a result: 130, as shells report it for any interrupted program.

mod alarms;
mod calibrated;
mod cli;
mod commands;
mod device;
mod interrupt;
mod live_watch;
mod output;
mod provenance;
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
