//! `compare`: a recording beside the output of a simulator.

use std::path::PathBuf;

use socam_compare::{ChannelComparison, Comparison, Document, ModelCheck, Options, Verdict};
use socam_recording::Dataset;
use socam_sim::{Replay, Start, Truth};

use super::{Outcome, diagnose};
use crate::output::{self, WrongArguments};
use crate::{model_file, table};

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
    /// Recording, or a part of it: RUN@FROM..TO in seconds
    #[arg(value_name = "RUN")]
    run: String,
    /// Output of a simulator
    #[arg(value_name = "SIM")]
    simulation: String,
    /// Compare a simulated channel with a measured one of another name; may be repeated
    #[arg(long, value_name = "SIMULATED=MEASURED")]
    map: Vec<String>,
    /// Seconds to add to the simulation's times
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, allow_hyphen_values = true)]
    offset: f64,
    /// False alarm rate, 0 to 1: share of right simulations of which a difference is reported
    #[arg(long, value_name = "P", default_value_t = 0.01)]
    false_alarm_rate: f64,
    #[arg(long, value_name = "MODEL", help = model_file::HELP)]
    model: Option<String>,
    /// Write index.html and comparison.json into this directory
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    if !(args.false_alarm_rate > 0.0 && args.false_alarm_rate < 1.0) {
        let problem =
            format!("--false-alarm-rate {}: expected a number between 0 and 1", args.false_alarm_rate);
        return Err(WrongArguments(problem).into());
    }
    if !args.offset.is_finite() {
        return Err(WrongArguments(format!("--offset {}: expected seconds", args.offset)).into());
    }
    let model = args.model.as_deref().map(model_file::load).transpose()?;
    let recording = output::open_regular(&args.run)?;
    let simulation = socam_compare::shifted(output::open(&args.simulation)?, args.offset)?;
    let options = Options { false_alarm_rate: args.false_alarm_rate };
    let comparison =
        socam_compare::compare(&socam_compare::pair(&recording, &simulation, &args.map)?, &options);
    let model = match (&args.model, model) {
        (Some(name), Some(model)) => Some(check(name, model, &args, &simulation, &options)?),
        _ => None,
    };
    let sentences = socam_compare::sentences(&comparison);
    if let Some(folder) = &args.report {
        let about = [
            format!(
                "socam-host {}, of {}",
                env!("CARGO_PKG_VERSION"),
                std::env::args().collect::<Vec<_>>().join(" ")
            ),
            format!("false alarm rate {}", args.false_alarm_rate),
        ];
        let document = serde_json::to_string_pretty(&Document::new(&comparison, None))?;
        let page = socam_report::comparison::page(&comparison, &about);
        output::write_folder(folder, &[("comparison.json".into(), document), ("index.html".into(), page)])?;
    }
    if args.json {
        output::print_json(&Document::new(&comparison, model))?;
    } else {
        output::print(&text(&comparison, &sentences, model.as_ref()))?;
    }
    if let (Some(model), false) = (&args.model, args.json) {
        output::print("\nWhat the model lacks\n")?;
        diagnose::of_one(&args.run, model)?;
    }
    Ok(Outcome::on([&recording, &simulation]))
}

/// Simulates a model on the recording's inputs, and compares the user's simulation with it.
fn check(
    name: &str,
    model: socam_model::Model,
    args: &Args,
    simulation: &Dataset,
    options: &Options,
) -> anyhow::Result<ModelCheck> {
    let data = output::open_for(&args.run, &model, socam_expectation::GRID_PARTS)?;
    let truth = Truth::new(&model, &[], &[])?;
    let replay = Replay { truth, disturbances: Vec::new(), start: Start::Rest };
    let replayed = replay.run(&data)?;
    let own = Dataset::from_columns(name, replayed.columns, replayed.time_s, replayed.values)?;
    let pairing = socam_compare::pair(&own, simulation, &args.map)?;
    let comparison = socam_compare::compare(&pairing, options);
    let largest = comparison.channels.iter().map(|channel| channel.error_share).fold(0.0, f64::max);
    let mut sentences = vec![format!(
        "The simulator and {name} on the same inputs, from rest, are apart by {} % of a channel's standard deviation at most.",
        table::number(100.0 * largest)
    )];
    sentences.push(if largest < 0.01 {
        format!("They hold the same physics: what {name} lacks is what the simulator lacks.")
    } else {
        format!("They are different models, or start differently (--json lists the channels): what {name} lacks may not be what the simulator lacks.")
    });
    Ok(ModelCheck { model: name.to_owned(), sentences, comparison })
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
