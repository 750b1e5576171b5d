//! Do 95 % intervals hold the truth 95 % of the time? Random benches of known truth, simulated by `socam-sim` with drive,
//! sensors and converters, and identified with default options.
//!
//! `cargo bench -p socam-tests --bench coverage -- --benches 300` prints the table. Cases with even numbers are for tuning the
//! estimator; those with odd numbers are kept aside, and run only with `--kept-aside`. A case depends on the seed and its number
//! alone: `--case 17` runs one of them and tells everything about it.

mod case;
mod crew;
mod report;
mod tally;
mod trial;

use std::process::ExitCode;

use case::{Case, Family};
use clap::Parser;
use trial::Trial;

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
    /// One noise level of the input only, 0 (none) to 3
    #[arg(long, value_name = "LEVEL")]
    level: Option<usize>,
    /// One case alone, with everything about it
    #[arg(long, value_name = "NUMBER")]
    case: Option<u64>,
    /// One line for each case
    #[arg(long)]
    list: bool,
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
    if let Some(number) = args.case {
        let trials = crew::run(vec![Case::draw(args.seed, number)?], 1)?;
        trials.iter().for_each(|trial| print!("{}", report::detail(trial)));
        return Ok(());
    }
    let cases = (0..args.benches).map(|number| Case::draw(args.seed, number));
    let cases: Result<Vec<Case>, String> =
        cases.filter(|case| case.as_ref().is_ok_and(|case| args.wants(case)) || case.is_err()).collect();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let trials = crew::run(cases?, args.threads.unwrap_or(cores))?;
    if args.list {
        trials.iter().for_each(|trial| println!("{}", report::line(trial)));
        println!();
    }
    let half = |aside: bool| {
        trials.iter().filter(|trial| trial.case.is_kept_aside() == aside).collect::<Vec<&Trial>>()
    };
    println!("{}", report::summary("for tuning", &half(false)));
    if args.kept_aside {
        println!("{}", report::summary("kept aside", &half(true)));
        println!("{}", report::summary("both halves", &trials.iter().collect::<Vec<_>>()));
    }
    println!(
        "one case alone: cargo bench -p socam-tests --bench coverage -- --seed {} --case NUMBER",
        args.seed
    );
    Ok(())
}

impl Args {
    fn wants(&self, case: &Case) -> bool {
        (self.kept_aside || !case.is_kept_aside())
            && self.only.is_none_or(|family| family == case.family)
            && self.level.is_none_or(|level| level == case.level)
    }
}
