//! `design`: the next experiment, as a profile that `record` runs.

mod text;

use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

use indicatif::ProgressBar;

use super::Outcome;
use crate::output;
use text::text;

/// Propose the next experiment: the most informative profile within the rig's limits
///
/// Runs profiles of several families on a virtual bench of the model, without noise, and computes their Fisher information from the model's
/// sensitivities. Without --rival it proposes the profile that minimises the widest 95 % interval; with a rival model, the profile that
/// maximises the difference between both models that remains after fits of their parameters.
#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("a rival or recordings").args(["rival", "runs"])))]
#[command(group(clap::ArgGroup::new("a diagnosis or recordings").args(["diagnosis", "runs"])))]
#[command(after_help = "Examples:
  socam-host design --model bench.toml --duration 10s -o next.toml
  socam-host design run1.mcap --model bench.toml --limit torque_out=20 -o next.toml
  socam-host design --model friction.toml --rival hysteresis.toml -o apart.toml
  socam-host design --diagnosis report/diagnosis.json --model speed-o-cam -o apart.toml
  socam-host record --device serial --profile next.toml --duration 10s -o run2.mcap")]
pub(crate) struct Args {
    /// Existing recordings, whose information is taken into account
    #[arg(value_name = "RUN")]
    runs: Vec<String>,
    #[command(flatten)]
    task: socam_job::Design,
    /// Write the profile to this file
    #[arg(short = 'o', long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the profile, if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(mut args: Args) -> anyhow::Result<Outcome> {
    args.runs = output::expanded(&args.runs)?;
    let target = args.output.as_deref().map(|path| output::create_new(path, args.force)).transpose()?;
    let (model, rival) = args.task.load()?;
    let recorded = args.runs.iter().map(|run| output::open(run)).collect::<anyhow::Result<Vec<_>>>()?;
    let bar = ProgressBar::new_spinner();
    bar.enable_steady_tick(Duration::from_millis(200));
    let tried = |count: usize| bar.set_message(format!("{count} profiles tried"));
    let done = args.task.run(&model, rival, &recorded, &tried)?;
    bar.finish_and_clear();
    if let Some(mut target) = target {
        target.write_all(done.profile.as_bytes())?;
        target.commit()?;
    }
    if args.json {
        output::print_json(&done.document())?;
    } else {
        output::print(&text(&done, args.output.as_deref()))?;
    }
    Ok(Outcome::on(&recorded))
}
