//! The command line as it is typed.

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};

use crate::commands::Command;
use crate::output::{self, WrongArguments};

/// From recordings of a drivetrain bench to a model one can trust
#[derive(Debug, Parser)]
#[command(name = "socam-host", version, max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The command that was typed. When there is none to run: the exit code, and everything is said (help, or what is wrong).
pub(crate) fn read() -> Result<Command, ExitCode> {
    let error = match Cli::try_parse() {
        Ok(cli) => return Ok(cli.command),
        Err(error) => error,
    };
    if !error.use_stderr() {
        // Help, to a reader who may have gone away.
        let _ = error.print();
        return Err(ExitCode::SUCCESS);
    }
    let message = match error.kind() {
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand => no_command(),
        _ => sentence(&error.render().to_string()),
    };
    Err(output::report(&WrongArguments(message).into()))
}

fn no_command() -> String {
    let cli = Cli::command();
    let names: Vec<&str> = cli.get_subcommands().map(clap::Command::get_name).collect();
    format!("no command was given; there are {} (socam-host --help says what they do)", names.join(", "))
}

/// One sentence of what the parser says in paragraphs: what is wrong, tips, and the usage last.
fn sentence(paragraphs: &str) -> String {
    let text = paragraphs.split("For more information").next().unwrap_or_default();
    let text = text.strip_prefix("error: ").unwrap_or(text);
    let parts: Vec<String> = text
        .split("\n\n")
        .map(|part| part.split_whitespace().collect::<Vec<_>>().join(" "))
        .filter(|part| !part.is_empty())
        .map(|part| part.replace("tip: ", "").replacen("Usage:", "usage:", 1))
        .collect();
    parts.join("; ")
}
