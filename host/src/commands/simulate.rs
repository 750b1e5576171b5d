//! `simulate`: a virtual bench, or a model driven by recorded inputs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;
use socam_identify::{Local, Options, Problem};
use socam_recording::{Dataset, Selection, export_csv, import_mcap, temporary_beside};
use socam_sim::{Begin, Disturbance, OutputError, Replay, Replayed, Start, Truth};

use super::Outcome;
use super::record::{self, CourseArgs, attachment};
use crate::device::run::{self, End, Plan, Report};
use crate::device::virtual_bench::BenchArgs;
use crate::device::{self, Device, Pace};
use crate::interrupt::Interrupt;
use crate::output::{self, WrongArguments};
use crate::{model_file, table};

/// Simulate the bench on a profile, or drive a model by the inputs of a recording and compare
///
/// With --profile, a virtual bench is recorded like a real one, with noise; the same arguments give the same file. With --input, the model
/// is driven by the recorded inputs, and its predictions are compared with the measurement.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host simulate --profile multisine -o run.mcap
  socam-host simulate --profile steps --duration 10s --set k4=134 --hide coulomb_friction@load_bearing:torque=0.3 -o run.csv
  socam-host simulate --input run.mcap --model bench.toml
  socam-host simulate --input axis.csv --model emps-loop -o predicted.csv")]
#[command(group(clap::ArgGroup::new("course").args(["profile", "input"]).required(true)))]
pub(crate) struct Args {
    /// Recording to write (.mcap or .csv)
    #[arg(short, long, value_name = "RUN", required_unless_present = "input")]
    output: Option<PathBuf>,
    #[command(flatten)]
    course: CourseArgs,
    /// Recording whose inputs drive the model, or a part of it: RUN@FROM..TO in seconds
    #[arg(long, value_name = "RUN", conflicts_with_all = ["duration", "rate", "no_noise"])]
    input: Option<String>,
    /// A column of that recording that acts in addition to the model's inputs: a torque (N m) or force (N) on a node, or V on a servo's drive
    #[arg(long, value_name = "COLUMN@PLACE", requires = "input")]
    disturb: Vec<Disturbance>,
    #[arg(long, value_name = "[INPUT=]KIND", requires = "input", help = model_file::BETWEEN_HELP)]
    between: Vec<String>,
    /// Start at rest [default: start states that fit the whole recording best]
    #[arg(long, requires = "input")]
    from_rest: bool,
    #[command(flatten)]
    bench: BenchArgs,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let kind = args.output.as_deref().map(Kind::of).transpose()?;
    if let (Some(input), Some(path)) = (&args.input, &args.output) {
        output::check_target(path, &Selection::parse(input)?.path, true)?;
    }
    match (&args.input, &args.output, kind) {
        (Some(input), _, kind) => compare(&args, input, kind),
        (None, Some(path), Some(kind)) => simulate(&args, path, kind),
        _ => Err(WrongArguments("simulate needs --output".into()).into()),
    }
}

/// Format of the output, by its extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Mcap,
    Csv,
}

impl Kind {
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
fn simulate(args: &Args, path: &Path, kind: Kind) -> anyhow::Result<Outcome> {
    let part = temporary_beside(path)?;
    // The recorder creates it anew, under this name.
    std::fs::remove_file(&part).with_context(|| format!("cannot write `{}`", path.display()))?;
    Interrupt::listen().unfinished(Some(&part));
    let report = simulate_into(&args.course, &args.bench, &part)?;
    if let End::Fault(reason) | End::Broken(reason) = &report.end {
        anyhow::bail!("the virtual board ended the run: {reason}; `{}` is not written", path.display());
    }
    match kind {
        Kind::Mcap => {
            part.persist(path).with_context(|| format!("cannot write `{}`", path.display()))?;
        }
        Kind::Csv => export_csv(&Dataset::open_selection(&Selection::whole(&part))?, path)?,
    }
    Interrupt::listen().unfinished(None);
    record::tell(path, &report, args.course.rate, args.json)?;
    record::outcome(path, &report)
}

/// Runs a profile on the virtual bench as fast as it can. The same arguments give the same file.
pub(crate) fn simulate_into(course: &CourseArgs, bench: &BenchArgs, path: &Path) -> anyhow::Result<Report> {
    let setup = bench.setup(None)?;
    let metadata = [("device", "simulation".to_owned()), ("seed", bench.seed.to_string())];
    let mut plan = record::plan(course, path.to_owned())?;
    plan.calibration = setup.calibration.clone();
    plan.metadata.extend(metadata.map(|(name, value)| (name.to_owned(), value)));
    plan.attachments.extend(attachment("model.toml", model_file::text(&bench.model)?));
    let plan = Plan { replace: true, ..plan };
    let mut session = device::open(&Device::Sim, Some((setup, Pace::Fast)))?;
    // Nothing real moves, so Ctrl-C ends the process.
    run::record(&mut session, plan, &Interrupt::default())
}

/// Drives the model by the inputs of a recording.
fn compare(args: &Args, input: &str, kind: Option<Kind>) -> anyhow::Result<Outcome> {
    let mut truth = args.bench.truth()?;
    model_file::set_between(&mut truth.model, &args.between)?;
    let data = output::open_for(input, &truth.model, socam_expectation::GRID_PARTS)?;
    let kinds = truth.model.inputs().filter(|input| !input.quantity.is_clock());
    let between = kinds.map(|input| (input.name.clone(), input.intersample().name())).collect();
    let start = if args.from_rest { Start::Rest } else { start(&truth, &data, &args.disturb) };
    let replay = Replay { truth, disturbances: args.disturb.clone(), start };
    let replayed = replay.run(&data)?;
    if let (Some(path), Some(kind)) = (&args.output, kind) {
        write(&replayed, path, kind)?;
    }
    let comparison = Comparison {
        schema: "socam.comparison/1",
        model: replay.truth.model.name.clone(),
        input: input.to_owned(),
        output: args.output.as_ref().map(|path| path.display().to_string()),
        between,
        start: if args.from_rest { "rest" } else { "fitted" },
        rows: replayed.time_s.len(),
        channels: replayed.errors.iter().map(ChannelError::from).collect(),
    };
    if args.json {
        output::print_json(&comparison)?;
    } else {
        output::print(&comparison.to_text())?;
    }
    Ok(Outcome::on([&data]))
}

/// Start states that fit the whole recording best, as `identify` estimates them; if it cannot (for example without the model's
/// outputs), those that the simulator computes.
fn start(truth: &Truth, data: &Dataset, disturbances: &[Disturbance]) -> Start {
    let Truth { model, values, .. } = truth;
    let fitted = || {
        let datasets = std::slice::from_ref(data);
        let problem = Problem::of_known(model, datasets, Options::default()).ok()?;
        socam_identify::start_states(&problem, values).ok()
    };
    // A disturbance is none of that model's inputs.
    let fitted = if disturbances.is_empty() { fitted() } else { None };
    let begin = |local: Local| {
        let Local { first_row, states, offsets, .. } = local;
        Begin { first_row, states, offsets }
    };
    fitted.map_or(Start::Fitted, |fitted| Start::Given(fitted.into_iter().map(begin).collect()))
}

fn write(replayed: &Replayed, path: &Path, kind: Kind) -> anyhow::Result<()> {
    let name = path.display().to_string();
    let (columns, values) = (replayed.columns.clone(), replayed.values.clone());
    let simulated = Dataset::from_columns(name, columns, replayed.time_s.clone(), values)?;
    match kind {
        Kind::Csv => export_csv(&simulated, path)?,
        Kind::Mcap => {
            let metadata = [("device".to_owned(), "simulation".to_owned())].into();
            import_mcap(&simulated, 0, metadata, Vec::new(), path)?;
        }
    }
    Ok(())
}

/// The names are part of the JSON document.
#[derive(Serialize)]
struct Comparison {
    schema: &'static str,
    model: String,
    input: String,
    output: Option<String>,
    between: BTreeMap<String, &'static str>,
    start: &'static str,
    rows: usize,
    channels: Vec<ChannelError>,
}

#[derive(Serialize)]
struct ChannelError {
    channel: String,
    unit: &'static str,
    samples: usize,
    rms: f64,
    max: f64,
    relative_percent: f64,
}

impl From<&OutputError> for ChannelError {
    fn from(error: &OutputError) -> Self {
        Self {
            channel: error.channel.clone(),
            unit: error.unit,
            samples: error.samples,
            rms: error.rms,
            max: error.max,
            relative_percent: error.relative_percent,
        }
    }
}

impl Comparison {
    fn to_text(&self) -> String {
        let course: Vec<_> = self.between.iter().map(|(input, kind)| format!("{input} {kind}")).collect();
        let course = course.join(", ");
        let mut text = format!(
            "{} driven by {} ({} rows; between samples: {course})\n",
            self.model, self.input, self.rows
        );
        if self.channels.is_empty() {
            text.push_str("  it holds none of the model's outputs to compare with\n");
            return text;
        }
        let mut rows =
            vec![["channel", "unit", "error rms", "error max", "relative %"].map(str::to_owned).to_vec()];
        rows.extend(self.channels.iter().map(|error| {
            let numbers = [error.rms, error.max, error.relative_percent].map(table::number);
            [vec![error.channel.clone(), error.unit.into()], numbers.to_vec()].concat()
        }));
        text + &table::align(&rows, &[false, false, true, true, true])
    }
}
