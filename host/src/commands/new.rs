//! `new`: a model file from a short description.

use std::io::{self, BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use socam_builder::{DescribeError, Description, GRAMMAR, describe};
use socam_recording::Dataset;

use super::Outcome;
use crate::output::{self, WrongArguments};

/// Write a model file from a line that says what a machine consists of
///
/// Start values come from masses, sizes and usual values; each parameter says from which. With RUN, columns are looked up in the
/// recording, and an inertia without a size starts from the recorded torque over acceleration. In a terminal, what is not given is asked.
#[derive(Debug, clap::Args)]
#[command(after_help = after_help())]
pub(crate) struct Args {
    /// A recording of the machine in any format that `import` reads, or a part of it: RUN@FROM..TO in seconds or clock times
    #[arg(value_name = "RUN")]
    run: Option<String>,
    /// Model file to write; `-` for stdout
    #[arg(short, long, value_name = "FILE", default_value = "machine.toml")]
    output: PathBuf,
    /// Parts from the motor to the load, see below
    #[arg(long, value_name = "PARTS")]
    chain: Option<String>,
    /// What drives the machine, or `none` where it swings freely; may be repeated
    #[arg(long = "drive", value_name = "QUANTITY@PART[:COLUMN]")]
    drives: Vec<String>,
    /// What is measured; may be repeated
    #[arg(long = "measure", value_name = "QUANTITY@PART[:COLUMN]")]
    measures: Vec<String>,
    /// Name of the model [default: that of the file]
    #[arg(long)]
    name: Option<String>,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

fn after_help() -> String {
    format!(
        "{GRAMMAR}

Examples:
  socam-host new -o axis.toml --chain \"motor 0.9kgcm2 | coupling 800Nm/rad | gear 5 | shaft 20x300mm steel | load disc 4kg 200mm\" \\
      --drive torque@motor:motor_current_A*0.055 --measure speed@motor --measure angle@load
  socam-host new -o stage.toml --chain \"motor | coupling jaw | screw 5mm | slide 12kg\" --drive current@motor:i_A*0.1 --measure position@slide:x_m
  socam-host new log.csv -o rig.toml          in a terminal: asks for the rest, and shows the columns of log.csv"
    )
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let to_stdout = args.output.as_os_str() == "-";
    // The file is created first, so that an error is reported before any question.
    let target = (!to_stdout).then(|| output::create_new(&args.output, args.force)).transpose()?;
    let data = args.run.as_deref().map(|run| output::open_on(socam_job::Grid::View, run)).transpose()?;
    let (chain, drives, measures) = answers(&args, data.as_ref())?;
    let name = args.name.clone().unwrap_or_else(|| stem(&args.output));
    let description = Description { name: &name, chain: &chain, drives: &drives, measures: &measures };
    let described = describe(&description, data.as_ref()).map_err(|error| match error {
        DescribeError::Recording(error) => anyhow::Error::new(error),
        error => WrongArguments(error.to_string()).into(),
    })?;
    for note in &described.notes {
        output::say(note);
    }
    let outcome = Outcome::on(&data);
    let Some(mut target) = target else {
        output::print(&described.text)?;
        return Ok(outcome);
    };
    let path = args.output.display();
    target.write_all(described.text.as_bytes()).with_context(|| format!("cannot write `{path}`"))?;
    target.commit()?;
    output::say(format_args!(
        "{path} written; see it with `socam-host model show {path}`, then `socam-host check RUN --model {path}`"
    ));
    Ok(outcome)
}

fn stem(path: &Path) -> String {
    let stem = path.file_stem().and_then(|stem| stem.to_str()).filter(|stem| *stem != "-");
    stem.unwrap_or("machine").to_owned()
}

/// Chain, drives and measurements: from the options, else asked for in a terminal.
fn answers(args: &Args, data: Option<&Dataset>) -> anyhow::Result<(String, Vec<String>, Vec<String>)> {
    let asks = io::stdin().is_terminal() && io::stderr().is_terminal();
    let chain = match &args.chain {
        Some(chain) => chain.clone(),
        None if asks => ask(&format!("{GRAMMAR}\n\nWhich parts are there, from the motor to the load?"))?,
        None => {
            let problem = "--chain is missing: say the parts from the motor to the load, such as --chain \"motor 0.9kgcm2 | coupling jaw | load disc 4kg 200mm\" (new --help lists them)";
            return Err(WrongArguments(problem.into()).into());
        }
    };
    let mut drives = args.drives.clone();
    let mut measures = args.measures.clone();
    if asks && (drives.is_empty() || measures.is_empty()) {
        if let Some(data) = data {
            output::say(format_args!(
                "columns of the recording: {}",
                socam_builder::columns(data).join(", ")
            ));
        }
        if drives.is_empty() {
            drives.push(ask("What drives it? (such as torque@motor:COLUMN*0.055, or none)")?);
        }
        while measures.is_empty() || args.measures.is_empty() {
            let question = "What is measured? (such as speed@load:COLUMN; an empty line ends)";
            match ask(question)? {
                answer if answer.is_empty() => break,
                answer => measures.push(answer),
            }
        }
    }
    if asks && (args.chain.is_none() || args.drives.is_empty() || args.measures.is_empty()) {
        let run = args.run.as_ref().map_or(String::new(), |run| format!(" {run}"));
        let list = |option: &str, all: &[String]| -> String {
            all.iter().map(|text| format!(" {option} \"{text}\"")).collect()
        };
        output::say(format_args!(
            "the same without questions: socam-host new{run} -o {} --chain \"{chain}\"{}{}",
            args.output.display(),
            list("--drive", &drives),
            list("--measure", &measures)
        ));
    }
    Ok((chain, drives, measures))
}

/// Asks on stderr, so that stdout holds only the result.
fn ask(question: &str) -> anyhow::Result<String> {
    let mut stderr = io::stderr().lock();
    write!(stderr, "{question}\n> ").and_then(|()| stderr.flush()).context("cannot ask")?;
    let mut answer = String::new();
    io::stdin().lock().read_line(&mut answer).context("cannot read the answer")?;
    Ok(answer.trim().to_owned())
}
