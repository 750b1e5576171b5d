//! `fleet`: diagnoses of many recordings of sister machines, and their summary.

mod progress;
mod text;

use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;
use socam_fleet::{FleetOptions, Part, Source, Summary, Table, table};
use socam_job::{FleetRow, Settings, rules::check_rate};
use socam_model::Model;

use super::Outcome;
use crate::interrupt::Interrupt;
use crate::output::{self, WrongArguments};
use progress::Progress;

/// Diagnose all recordings of a fleet of sister machines: a table with a row for each, and what is wrong how often and where
///
/// Each recording is checked, fitted and tested; only what stands out gets the full diagnosis. Bad input is a row that says so. Machine and
/// date are those of the list, else of the log (`record --machine`), else the first folder and a date YYYY-MM-DD of the path. A run that
/// ends early goes on where it was; shards are merged to the same bytes as one run.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host fleet RECORDINGS --model machine.toml --reference HEALTHY -o fleet.parquet --report fleet.html
  socam-host fleet list.csv --model machine.toml -o part-7.parquet --shard 7/100      a job of a Slurm array
  socam-host fleet --merge part-*.parquet -o fleet.parquet --report fleet.html")]
pub(crate) struct Args {
    /// Folder of recordings, or a list (CSV with the columns file, machine, date); with --merge the tables of shards
    #[arg(value_name = "DIR|LIST", required = true)]
    places: Vec<PathBuf>,
    #[command(flatten)]
    row: FleetRow,
    /// Table of the fleet to write (Parquet)
    #[arg(short, long, value_name = "FLEET.parquet")]
    output: PathBuf,
    /// Recordings of healthy machines, a folder or list of them, or what --write-reference wrote: their noise is what others are tested against
    #[arg(long, value_name = "HEALTHY", num_args = 1..)]
    reference: Vec<PathBuf>,
    /// Write what the reference recordings show to this file, for further runs and all shards
    #[arg(long, value_name = "FILE.toml", requires = "reference")]
    write_reference: Option<PathBuf>,
    /// Every N-th recording only, from the I-th, as I/N
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with = "merge")]
    shard: Option<(usize, usize)>,
    /// Merge the tables of shards into one
    #[arg(long)]
    merge: bool,
    /// False discovery rate of each list: faulty machines, trends, odd machines
    #[arg(long, value_name = "Q", default_value_t = 0.05)]
    fdr: f64,
    /// Recordings at a time, each on one thread [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Write a page about the fleet
    #[arg(long, value_name = "PAGE.html")]
    report: Option<PathBuf>,
    /// Replace the files of --report and --write-reference, if they exist
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

fn shard(text: &str) -> Result<(usize, usize), String> {
    let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    numbers.filter(|(i, n)| (1..=*n).contains(i)).ok_or_else(|| "expected I/N, as in 1/4 to 4/4".into())
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    check_rate("fdr", "--fdr", args.fdr)?;
    args.row.validate()?;
    let mut named = args.report.iter().chain(&args.write_reference);
    named.try_for_each(|path| output::check_free(path, args.force))?;
    if args.merge {
        table::merge(&args.places, &args.output)?;
    } else if !diagnose(&args)? {
        anyhow::bail!("stopped before all recordings were done; the same command goes on from here");
    }
    let summary = Summary::of(Table::open(&args.output)?, args.fdr)?;
    if let Some(path) = &args.report {
        let command = std::env::args().skip(1).fold("socam-host".to_owned(), |text, word| text + " " + &word);
        let about = vec![command];
        output::write_whole(path, &socam_report::fleet::page(&summary, &args.output, &about)?)?;
    }
    if args.json {
        output::print_json(&Document { table: args.output.display().to_string(), summary: &summary })?;
    } else {
        output::print(&text::of(&summary))?;
    }
    Ok(Outcome::Done)
}

#[derive(Serialize)]
struct Document<'s> {
    table: String,
    #[serde(flatten)]
    summary: &'s Summary,
}

/// Makes the table; `false` where it was stopped.
fn diagnose(args: &Args) -> anyhow::Result<bool> {
    let model = socam_job::load_model(&args.row.model)?;
    let mut options = FleetOptions::from(&args.row);
    options.frozen = reference(args, (&model, &options))?;
    let sources = all(&args.places, &args.output)?;
    let (number, of) = args.shard.unwrap_or((1, 1));
    let sources = socam_fleet::shard(sources, number, of);
    let part_path = PathBuf::from(format!("{}.part", args.output.display()));
    let mut part = Part::open(&part_path)?;
    keep(&args.output, &mut part)?;
    let workers = args.jobs.map_or_else(cores, usize::from);
    let interrupt = Interrupt::listen();
    // The first interrupt ends the run after the recordings that have begun; the second one ends the process at once.
    interrupt.answer(1);
    let progress = Progress::new(sources.len(), interrupt.clone());
    // The row contains the message of a panic.
    std::panic::set_hook(Box::new(|_| {}));
    let done = socam_fleet::run(&sources, (&model, &options, args.row.seed), workers, &mut part, &progress);
    let _ = std::panic::take_hook();
    progress.finish();
    interrupt.end_after(0);
    let Some(ids) = done? else { return Ok(false) };
    let wanted: std::collections::BTreeSet<(&str, &str)> =
        sources.iter().map(|source| source.name.as_str()).zip(ids.iter().map(String::as_str)).collect();
    let is_wanted = |recording: &str, id: &str| wanted.contains(&(recording, id));
    let about = table::About::new(&model, &options, args.row.seed);
    table::write(&args.output, &about, part.rows(&is_wanted))?;
    drop(part);
    std::fs::remove_file(&part_path).with_context(|| format!("cannot remove `{}`", part_path.display()))?;
    Ok(true)
}

/// The recordings of several folders or lists.
fn all(places: &[PathBuf], output: &Path) -> anyhow::Result<Vec<Source>> {
    let mut found = Vec::new();
    for place in places {
        found.extend(socam_fleet::sources(place, &[output, place])?);
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    if let Some(pair) = found.windows(2).find(|pair| pair[0].name == pair[1].name) {
        let message = format!("two recordings have the name `{}`; give the folder above them", pair[0].name);
        return Err(WrongArguments(message).into());
    }
    if found.is_empty() {
        let places: Vec<_> = places.iter().map(|place| place.display().to_string()).collect();
        return Err(WrongArguments(format!("there is no recording in {}", places.join(", "))).into());
    }
    Ok(found)
}

/// Takes over the rows of an earlier table, so that only new recordings are diagnosed.
fn keep(output: &Path, part: &mut Part) -> anyhow::Result<()> {
    if !output.exists() {
        return Ok(());
    }
    for row in Table::open(output).context("--output names a file that is there already")? {
        let row = row?;
        if !part.holds(&row.recording, &row.id) {
            part.append(&row)?;
        }
    }
    Ok(())
}

/// Noise reference, read from a file or computed from recordings.
fn reference(
    args: &Args,
    (model, options): (&Model, &FleetOptions),
) -> anyhow::Result<Option<socam_fleet::Frozen>> {
    let is_file = |path: &&PathBuf| path.extension().is_some_and(|extension| extension == "toml");
    if let Some(path) = args.reference.iter().find(is_file) {
        let text = socam_recording::read_text(path)?;
        let frozen: socam_fleet::Frozen =
            toml::from_str(&text).with_context(|| format!("`{}` is no reference", path.display()))?;
        frozen.check(model).map_err(|problem| WrongArguments(format!("`{}`: {problem}", path.display())))?;
        return Ok(Some(frozen));
    }
    let mut sources = Vec::new();
    for place in &args.reference {
        let is_recording = socam_recording::detect(place).is_ok();
        let is_list = place.is_dir() || !is_recording;
        sources.extend(if is_list { socam_fleet::sources(place, &[])? } else { vec![Source::path(place)] });
    }
    let found = socam_fleet::reference(&sources, (model, options, args.row.seed))?;
    match &found {
        None => output::warn(
            "no --reference: the noise is taken from each recording itself, so that a sensor that became noisier is not seen",
        ),
        Some(frozen) if frozen.excess > socam_diagnose::INADEQUATE => output::warn(format_args!(
            "{} leaves {:.1} times the power of noise in the reference itself: correct the model with `diagnose` first, or every machine stands out",
            model.name, frozen.excess
        )),
        Some(_) => {}
    }
    if let (Some(path), Some(frozen)) = (&args.write_reference, &found) {
        output::write_whole(path, &toml::to_string(frozen)?)?;
    }
    Ok(found)
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
