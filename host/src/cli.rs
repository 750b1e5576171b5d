//! The command line.

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

/// Reads the command that was typed. If there is no command to run, returns the exit code after help or an error was printed.
pub(crate) fn read() -> Result<Command, ExitCode> {
    let error = match Cli::try_parse() {
        Ok(cli) => return Ok(cli.command),
        Err(error) => error,
    };
    if !error.use_stderr() {
        // Printing the help fails if the reader has closed the stream.
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

/// One sentence from the parser's message of several paragraphs: the mistake, tips, and the usage last.
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

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};
    use socam_job::options::{command_line, from_keywords};
    use socam_job::{
        Check, Compare, Design, Diagnose, FleetRow, Identify, Record, Response, Settings, Simulate, Watch,
    };

    /// Asserts that this program understands the command that a task prints.
    fn is_understood<T: Settings>(options: Value, inputs: &[(&str, &str)]) {
        let settings: T = from_keywords(options.as_object().unwrap().clone()).unwrap();
        let inputs: Vec<(&str, Vec<String>)> =
            inputs.iter().map(|(flag, own)| (*flag, own.split(' ').map(str::to_owned).collect())).collect();
        let inputs: Vec<(&str, &[String])> =
            inputs.iter().map(|(flag, own)| (*flag, own.as_slice())).collect();
        let line = command_line(&settings, &inputs).unwrap();
        Cli::try_parse_from(line.split(' ')).unwrap_or_else(|error| panic!("{line}: {error}"));
    }

    #[test]
    fn commands_that_tasks_print_are_understood() {
        Cli::command().debug_assert();
        is_understood::<Check>(json!({"ratio_tolerance": 0.02}), &[("", "a.mcap b.mcap")]);
        is_understood::<Identify>(
            json!({"band": [1, 50], "starts": 2}),
            &[("", "a.mcap"), ("--validate", "b.mcap")],
        );
        is_understood::<Response>(json!({"band": [1, 50], "low_pass": [100, 2]}), &[("", "a.mcap")]);
        is_understood::<Diagnose>(
            json!({"fixed": {"k3": 1}}),
            &[("", "a.mcap"), ("--holdout", "b.mcap c.mcap")],
        );
        is_understood::<Compare>(json!({"offset_s": -0.1}), &[("", "a.mcap b.csv")]);
        is_understood::<Watch>(
            json!({"window_s": 20, "fixed": ["k3"]}),
            &[("", "a.mcap"), ("--baseline", "b.mcap")],
        );
        is_understood::<Simulate>(json!({"profile": "steps", "noise": false}), &[("--output", "a.mcap")]);
        is_understood::<Simulate>(json!({"from_rest": true, "between": "hold"}), &[("--input", "a.mcap")]);
        is_understood::<Design>(json!({"limits": {"torque_out": 20}}), &[("", "a.mcap")]);
        is_understood::<FleetRow>(json!({"seed": 2}), &[("", "folder"), ("--output", "fleet.parquet")]);
        is_understood::<Record>(json!({"profile": "steps"}), &[("--output", "a.mcap"), ("--device", "sim")]);
    }

    #[test]
    fn options_of_the_other_kind_are_refused() {
        let refused = |words: &str| Cli::try_parse_from(words.split(' ')).unwrap_err().to_string();
        assert!(
            refused("socam-host simulate --profile steps --from-rest -o a.mcap")
                .contains("cannot be used with")
        );
        assert!(refused("socam-host simulate --input a.mcap --duration 10s").contains("cannot be used with"));
        assert!(refused("socam-host simulate --input a.mcap --no-noise").contains("cannot be used with"));
        assert!(refused("socam-host design a.mcap --rival b.toml").contains("cannot be used with"));
        assert!(refused("socam-host design a.mcap --diagnosis b.json").contains("cannot be used with"));
        assert!(refused("socam-host check a.mcap --model emps --input x").contains("cannot be used with"));
    }
}
