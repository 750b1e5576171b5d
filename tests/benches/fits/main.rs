//! How far can a fit be trusted? Random machines of known truth, recorded with flaws and with physics that their models lack, and identified
//! with default options.
//!
//! `cargo bench -p socam-tests --bench fits -- --seed 1 --cases 200` prints Markdown tables: how often a fit ends at the best known minimum,
//! how often 95 % intervals hold the true values by the size of the misfit, how often the verdict warns wrongly or not at all, and what a fit
//! costs. A case depends on the seed and its number alone: `--cases 17..18` runs one of them. The truth comes from the machines of
//! `socam_sim::challenge`, whose laws and integrator share nothing with the identification.

mod faults;
mod minimum;
mod misfit;
mod rig;
mod table;
mod trial;

use std::ops::Range;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use rig::Rig;
use trial::Trial;

/// Measure how far fits of random machines can be trusted
#[derive(Debug, Parser)]
struct Args {
    /// Another number, other cases
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Number of cases, or their range FROM..TO; TO is excluded
    #[arg(long, value_name = "N|A..B", default_value = "200", value_parser = range)]
    cases: Range<u64>,
    /// Write every case with all its parameters to a file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Number of threads; all cores when not given
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

/// `N` or `A..B`
fn range(text: &str) -> Result<Range<u64>, String> {
    let number = |text: &str| text.parse::<u64>().map_err(|_| format!("`{text}` is no number of cases"));
    match text.split_once("..") {
        Some((from, to)) => Ok(number(from)?..number(to)?),
        None => Ok(0..number(text)?),
    }
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<(), String> {
    let numbers: Vec<u64> = args.cases.clone().collect();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let work = |number: &u64| Trial::run(Rig::draw(args.seed, *number)?);
    let tell = |answer: &Result<Trial, String>, done: usize| {
        let said = answer.as_ref().map_or_else(|error| format!("error: {error}"), Trial::line);
        eprintln!("{done} of {}: {said}", numbers.len());
    };
    let answers = socam_tests::in_parallel(&numbers, args.jobs.unwrap_or(cores), work, tell)?;
    let trials = answers.into_iter().collect::<Result<Vec<_>, _>>()?;
    if let Some(path) = &args.json {
        let text = serde_json::to_string(&trials).map_err(|error| error.to_string())?;
        std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    print!("{}", table::summary(args.seed, &trials));
    Ok(())
}
