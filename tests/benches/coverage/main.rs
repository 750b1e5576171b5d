//! Do 95 % intervals hold the truth 95 % of the time? Random benches of known truth, simulated by `socam-sim` with drive,
//! sensors and converters, and identified with default options.
//!
//! `cargo bench -p socam-tests --bench coverage -- --benches 300` prints the table. Cases with even numbers are for tuning the
//! estimator; those with odd numbers are kept aside, and run only with `--kept-aside`. A case depends on the seed and its number
//! alone: `--case 17` runs one of them and tells everything about it.

mod bench;
mod case;
mod report;
mod table;
mod tally;
mod trial;

use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use bench::Bench;
use case::{Case, Family};
use clap::Parser;
use trial::Trial;

/// Where recordings are kept when no other folder is named.
const CACHE: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/coverage");

/// Count how often the intervals of random benches hold the truth
#[derive(Debug, Parser)]
struct Args {
    /// Number of random benches, those that are kept aside included
    #[arg(long, value_name = "N", default_value_t = 60)]
    benches: u64,
    /// Another number, other benches
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Run the half of the benches that no tuning may look at as well
    #[arg(long)]
    kept_aside: bool,
    /// One kind of bench only
    #[arg(long, value_name = "KIND")]
    only: Option<Family>,
    /// One noise level of the input only, from 0 (none) to 3
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u64).range(..case::LEVELS as u64))]
    level: Option<u64>,
    /// One case alone, with everything about it
    #[arg(long, value_name = "NUMBER", conflicts_with_all = ["only", "level", "kept_aside", "benches"])]
    case: Option<u64>,
    /// Let the board run so many times as fast and keep every so manieth sample, to tell what the steps of its command do
    #[arg(long, value_name = "TIMES", default_value = "1", value_parser = ["1", "2", "5", "10", "20"])]
    oversample: String,
    /// Begin every fit at the truth, with one start: what differs was a wrong minimum
    #[arg(long)]
    from_truth: bool,
    /// Keep recordings in a folder and use them again; not across changes of the simulation or the model's equations
    #[arg(long, value_name = "DIR", num_args = 0..=1, default_missing_value = CACHE)]
    cache: Option<PathBuf>,
    /// One line for each case: number, kind, noise of the input, recordings, end, and what missed by how many standard deviations
    #[arg(long)]
    list: bool,
    /// Write every quantity of every case to a table
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Number of threads; all cores when not given
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
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
    let oversample = args.oversample.parse().map_err(|_| "--oversample wants a number")?;
    let bench = Bench { oversample, cache: args.cache.clone() };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (cases, threads) = (args.cases()?, args.threads.unwrap_or(cores));
    let work = |case: &Case| Trial::run(case.clone(), &bench);
    let trials = socam_tests::in_parallel(&cases, threads, work, |_, done| tell(done, cases.len()))?;
    if let Some(path) = &args.csv {
        std::fs::write(path, report::csv(&trials)).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    if args.case.is_some() {
        trials.iter().for_each(|trial| print!("{}", report::detail(trial)));
        return Ok(());
    }
    if args.list {
        trials.iter().for_each(|trial| println!("{}", report::line(trial)));
        println!();
    }
    println!("{}", report::summary("for tuning", &half(&trials, false)));
    if args.kept_aside {
        println!("{}", report::summary("kept aside", &half(&trials, true)));
        println!("{}", report::summary("both halves", &trials.iter().collect::<Vec<_>>()));
    }
    println!("one case: cargo bench -p socam-tests --bench coverage -- --seed {} --case NUMBER", args.seed);
    Ok(())
}

/// Tells the progress, on a terminal only.
fn tell(done: usize, total: usize) {
    let mut stderr = std::io::stderr();
    if stderr.is_terminal() {
        let end = if done == total { "\r\x1b[K" } else { "" };
        let _ = write!(stderr, "\r{done} of {total} benches{end}");
    }
}

fn half(trials: &[Trial], aside: bool) -> Vec<&Trial> {
    trials.iter().filter(|trial| trial.case.is_kept_aside() == aside).collect()
}

impl Args {
    fn cases(&self) -> Result<Vec<Case>, String> {
        let draw = |number: u64| {
            let case = Case::draw(self.seed, number)?;
            Ok::<Case, String>(if self.from_truth { case.begun_at_truth() } else { case })
        };
        if let Some(number) = self.case {
            return Ok(vec![draw(number)?]);
        }
        let all = (0..self.benches).map(draw).collect::<Result<Vec<_>, _>>()?;
        let cases: Vec<Case> = all.into_iter().filter(|case| self.wants(case)).collect();
        if cases.is_empty() { Err("no bench is of that kind".into()) } else { Ok(cases) }
    }

    fn wants(&self, case: &Case) -> bool {
        (self.kept_aside || !case.is_kept_aside())
            && self.only.is_none_or(|family| family == case.family)
            && self.level.is_none_or(|level| level == case.level as u64)
    }
}
