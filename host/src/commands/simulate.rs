//! `simulate`: a virtual bench, or a model driven by recorded inputs.

use std::path::{Path, PathBuf};

use anyhow::Context;
use socam_job::{Record, ReplayDocument, Simulate, VirtualBench};
use socam_recording::{Dataset, Selection, export_csv, import_mcap, temporary_beside};

use super::Outcome;
use super::record::{self, attachment};
use crate::device::run::{self, End, Plan, Report};
use crate::device::{self, Device, Pace};
use crate::interrupt::Interrupt;
use crate::output::{self, WrongArguments};
use crate::table;

/// Simulate the bench on a profile, or drive a model by the inputs of a recording and compare
///
/// With --profile, a virtual bench is recorded like a real one, with noise; the same arguments give the same samples. With --input, the model
/// is driven by the recorded inputs, and its predictions are compared with the measurement.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host simulate --profile multisine -o run.mcap
  socam-host simulate --profile steps --duration 10s --set k4=134 --hide coulomb_friction@load_bearing:torque=0.3 -o run.csv
  socam-host simulate --input run.mcap --model bench.toml
  socam-host simulate --input axis.csv --model emps-loop -o predicted.csv")]
#[command(group(clap::ArgGroup::new("what is simulated").args(["profile", "input"]).required(true)))]
#[command(group(clap::ArgGroup::new("of a profile").args(["duration_s", "rate_hz", "noise"]).multiple(true).conflicts_with("input")))]
#[command(group(clap::ArgGroup::new("of an input").args(["disturb", "between", "from_rest"]).multiple(true).requires("input").conflicts_with("profile")))]
pub(crate) struct Args {
    /// Recording to write (.mcap or .csv)
    #[arg(short, long, value_name = "RUN", required_unless_present = "input")]
    output: Option<PathBuf>,
    /// Recording whose inputs drive the model, or a part of it: RUN@FROM..TO in seconds or clock times
    #[arg(long, value_name = "RUN")]
    input: Option<String>,
    #[command(flatten)]
    task: Simulate,
    /// Replace the recording to write, if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let kind = args.output.as_deref().map(OutputFormat::of).transpose()?;
    match (&args.input, &args.output) {
        (Some(input), Some(path)) => {
            output::check_target_of(path, &Selection::parse(input)?, args.force)?;
        }
        (None, Some(path)) => output::check_free(path, args.force)?,
        (_, None) => {}
    }
    match (&args.input, &args.output, kind) {
        (Some(input), _, kind) => compare(&args, input, kind),
        (None, Some(path), Some(kind)) => simulate(&args, path, kind),
        _ => Err(WrongArguments("simulate needs --output".into()).into()),
    }
}

/// Format of the output, by its extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum OutputFormat {
    Mcap,
    Csv,
}

impl OutputFormat {
    fn of(path: &Path) -> anyhow::Result<Self> {
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("mcap") => Ok(Self::Mcap),
            Some("csv") => Ok(Self::Csv),
            _ => {
                Err(WrongArguments(format!("`{}`: a simulation is written as .mcap or .csv", path.display()))
                    .into())
            }
        }
    }
}

/// Records the virtual bench into a temporary file, which is moved to its path once it is complete.
fn simulate(args: &Args, path: &Path, kind: OutputFormat) -> anyhow::Result<Outcome> {
    let part = temporary_beside(path)?;
    // The recorder creates it anew, under this name.
    std::fs::remove_file(&part).with_context(|| format!("cannot write `{}`", path.display()))?;
    Interrupt::listen().unfinished(Some(&part));
    let report = simulate_into(&args.task.record, &args.task.bench, &part)?;
    if let End::Fault(reason) | End::Broken(reason) = &report.end {
        anyhow::bail!("the virtual board ended the run: {reason}; `{}` is not written", path.display());
    }
    match kind {
        OutputFormat::Mcap => {
            part.persist(path).with_context(|| format!("cannot write `{}`", path.display()))?;
        }
        OutputFormat::Csv => export_csv(&Dataset::open_selection(&Selection::whole(&part))?, path)?,
    }
    Interrupt::listen().unfinished(None);
    record::tell(path, &report, args.task.record.rate_hz, args.json)?;
    record::outcome(path, &report)
}

/// Runs a profile on the virtual bench as fast as it can. The same arguments give the same samples.
pub(crate) fn simulate_into(record: &Record, bench: &VirtualBench, path: &Path) -> anyhow::Result<Report> {
    let setup = bench.setup(&bench.load()?, None)?;
    let metadata = [("device", "simulation".to_owned()), ("seed", bench.seed.to_string())];
    let mut plan = record::plan(record, path.to_owned())?;
    plan.calibration = setup.calibration.clone();
    plan.metadata.extend(metadata.map(|(name, value)| (name.to_owned(), value)));
    plan.attachments.extend(attachment("model.toml", socam_job::model_text(&bench.model)?));
    let plan = Plan { replace: true, ..plan };
    let mut session = device::open(&Device::Sim, Some((setup, Pace::Fast)))?;
    // Nothing real moves, so Ctrl-C ends the process.
    run::record(&mut session, plan, &Interrupt::default())
}

/// Drives the model by the inputs of a recording.
fn compare(args: &Args, input: &str, kind: Option<OutputFormat>) -> anyhow::Result<Outcome> {
    let model = args.task.bench.load()?;
    let (data, mut done) = args.task.replay(&model, |grid| output::open_on(grid, input))?;
    if let (Some(path), Some(kind)) = (&args.output, kind) {
        write(&done.simulated, path, kind)?;
        done.document.output = Some(path.display().to_string());
    }
    done.document.input = input.to_owned();
    if args.json {
        output::print_json(&done.document)?;
    } else {
        output::print(&text(&done.document))?;
    }
    Ok(Outcome::on([&data]))
}

fn write(simulated: &Dataset, path: &Path, kind: OutputFormat) -> anyhow::Result<()> {
    match kind {
        OutputFormat::Csv => export_csv(simulated, path)?,
        OutputFormat::Mcap => {
            let metadata = [("device".to_owned(), "simulation".to_owned())].into();
            import_mcap(simulated, 0, metadata, Vec::new(), path)?;
        }
    }
    Ok(())
}

fn text(done: &ReplayDocument) -> String {
    let between: Vec<_> = done.between.iter().map(|(input, kind)| format!("{input} {kind}")).collect();
    let between = match between.as_slice() {
        [] => String::new(),
        between => format!("; between samples: {}", between.join(", ")),
    };
    let mut text = format!("{} driven by {} ({} rows{between})\n", done.model, done.input, done.rows);
    if done.channels.is_empty() {
        text.push_str("  it holds none of the model's outputs to compare with\n");
        return text;
    }
    let mut rows =
        vec![["channel", "unit", "error rms", "error max", "relative %"].map(str::to_owned).to_vec()];
    rows.extend(done.channels.iter().map(|error| {
        let numbers = [error.rms, error.max, error.relative_percent].map(table::number);
        [vec![error.channel.clone(), error.unit.into()], numbers.to_vec()].concat()
    }));
    text + &table::align(&rows, &[false, false, true, true, true])
}
