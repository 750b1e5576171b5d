//! `compare`: a recording compared with the output of a simulator.

use std::path::PathBuf;

use socam_compare::{ChannelComparison, Comparison, Document, ModelCheck, Verdict};
use socam_job::{Grid, JobError, Settings};

use super::{Outcome, diagnose};
use crate::{output, table};

/// Compare a recording with the output of a simulator: where, when, at which speed and frequency they part
///
/// Both are recordings of any format that `import` reads; channels of the same name and unit are compared, and those that --map names. No
/// model is needed, and nothing about the sensors' noise: a difference is an error that depends on the simulated motion. With --model, that
/// model is simulated on the recording's inputs too, which tells missing physics from a difference between two simulators, and `diagnose`
/// names what it lacks.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host compare run.mcap simulink.csv
  socam-host compare run.csv@2..8 sim.parquet --map w_out=output_speed --report difference
  socam-host compare run.mcap sim.csv --model bench.toml")]
pub(crate) struct Args {
    /// Recording, or a part of it: RUN@FROM..TO in seconds or clock times
    #[arg(value_name = "RUN")]
    run: String,
    /// Output of a simulator
    #[arg(value_name = "SIM")]
    simulation: String,
    #[command(flatten)]
    task: socam_job::Compare,
    /// Write index.html and comparison.json into this directory
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Replace the page of --report, if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    args.task.validate()?;
    output::check_page(args.report.as_deref(), args.force)?;
    let model = args.task.model.as_deref().map(socam_job::load_model).transpose()?;
    let recording = output::open_on(Grid::View, &args.run)?;
    let simulation = output::open(&args.simulation)?;
    let driven = model
        .as_ref()
        .map(|model| Ok::<_, JobError>((model, output::open_on(Grid::Even(model), &args.run)?)));
    let driven = driven.transpose()?;
    let driven = driven.as_ref().map(|(model, inputs)| (*model, inputs));
    let done = args.task.run(&recording, simulation.clone(), driven)?;
    let sentences = socam_compare::sentences(&done.comparison);
    if let Some(folder) = &args.report {
        let about = [
            format!(
                "socam-host {}, of {}",
                env!("CARGO_PKG_VERSION"),
                std::env::args().collect::<Vec<_>>().join(" ")
            ),
            format!("false alarm rate {}", args.task.false_alarm_rate),
        ];
        let document = serde_json::to_string_pretty(&Document::new(&done.comparison, None))?;
        let page = socam_report::comparison::page(&done.comparison, &about);
        output::write_folder(folder, &[("comparison.json".into(), document), ("index.html".into(), page)])?;
    }
    if args.json {
        output::print_json(&done.document())?;
    } else {
        output::print(&text(&done.comparison, &sentences, done.model.as_ref()))?;
    }
    if let (Some(model), false) = (&args.task.model, args.json) {
        output::print("\nWhat the model lacks\n")?;
        let outcome = diagnose::of_one(&args.run, model)?;
        if outcome == Outcome::Interrupted {
            return Ok(outcome);
        }
    }
    if done.comparison.verdict == socam_compare::Verdict::NothingCompared {
        return Ok(Outcome::NothingJudged);
    }
    Ok(Outcome::on([&recording, &simulation]))
}

fn text(comparison: &Comparison, sentences: &[String], model: Option<&ModelCheck>) -> String {
    let mut text = sentences.iter().map(|sentence| format!("{sentence}\n")).collect::<String>();
    let head = ["channel", "unit", "std measured", "rms of error", "of std", "delay, ms", "gain", "differs"];
    let row = |channel: &ChannelComparison| {
        let word = if channel.differs { "yes" } else { "no" };
        vec![
            channel.name.clone(),
            channel.unit.to_owned(),
            table::number(channel.measured_std),
            table::number(channel.error_rms),
            format!("{} %", table::number(100.0 * channel.error_share)),
            channel.delay_s.map_or_else(|| "-".into(), |delay| table::number(1e3 * delay.value)),
            channel.gain.map_or_else(|| "-".into(), |gain| table::number(gain.value)),
            word.into(),
        ]
    };
    let rows: Vec<_> =
        std::iter::once(head.map(String::from).to_vec()).chain(comparison.channels.iter().map(row)).collect();
    text.push('\n');
    text.push_str(&table::align(&rows, &[false, false, true, true, true, true, true, false]));
    for warning in &comparison.warnings {
        text.push_str(&format!("note: {warning}\n"));
    }
    if let Some(model) = model {
        text.push('\n');
        model.sentences.iter().for_each(|sentence| text.push_str(&format!("{sentence}\n")));
    } else if comparison.verdict == Verdict::Differ {
        text.push_str("\nWhat is missing in the simulator: write its structure as a model file (`socam-host new`), then `socam-host diagnose`.\n");
    }
    text
}
