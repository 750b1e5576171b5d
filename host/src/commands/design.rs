//! `design`: the next experiment, as a profile that `record` runs.

mod rival;
mod text;

use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

use indicatif::ProgressBar;
use socam_design::{Document, Limits, Rig, five_steps};
use socam_model::Model;
use socam_recording::Calibration;
use socam_sim::{Setup, Truth, calibration_for};

use super::Outcome;
use crate::model_file;
use crate::output::{self, WrongArguments};
use rival::Rival;
use text::text;

/// Largest command of the profiles that suit the default bench, V.
const USUAL_V: f64 = 1.8;

/// Propose the next experiment: the most informative profile within the rig's limits
///
/// Runs profiles of several families on a virtual bench of the model, without noise, and computes their Fisher information from the model's
/// sensitivities. Without --rival it proposes the profile that minimises the widest 95 % interval; with a rival model, the profile that
/// maximises the difference between both models that remains after fits of their parameters.
#[derive(Debug, clap::Args)]
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
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = model_file::HELP)]
    model: String,
    /// A competing model of the same recordings
    #[arg(long, value_name = "MODEL", conflicts_with = "runs")]
    rival: Option<String>,
    /// The diagnosis.json of `diagnose --report`: compare its strongest finding with its first rival, each added to --model
    #[arg(long, value_name = "FILE", conflicts_with_all = ["runs", "rival"])]
    diagnosis: Option<PathBuf>,
    /// Length of the recording, as in 10s or 1.5min
    #[arg(long, value_name = "TIME", default_value = "10s", value_parser = crate::duration::seconds)]
    duration: f64,
    /// Largest command, V [default: 1.8, or the clamp of the calibration if that is less]
    #[arg(long, value_name = "VOLT")]
    voltage: Option<f64>,
    /// Fastest change of the command, V/s
    #[arg(long, value_name = "VOLT/S", default_value_t = 500.0)]
    slew: f64,
    /// Limit of a channel, SI, in place of the calibration's; may be repeated
    #[arg(long, value_name = "CHANNEL=VALUE")]
    limit: Vec<String>,
    /// Only profiles that do not change direction
    #[arg(long)]
    one_way: bool,
    /// Calibration file with motor, sensors and limits [default: one that suits the model]
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Write the profile to this file
    #[arg(short = 'o', long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let target = args.output.as_deref().map(output::create).transpose()?;
    let base = model_file::load(&args.model)?;
    let (model, rival) = models(&args, base)?;
    let rig = rig(&args, &model)?;
    let recorded = args.runs.iter().map(|run| output::open(run)).collect::<anyhow::Result<Vec<_>>>()?;
    let bar = ProgressBar::new_spinner();
    bar.enable_steady_tick(Duration::from_millis(200));
    let progress = |count: usize| bar.set_message(format!("{count} profiles tried"));
    let design = match &rival {
        Some(rival) => socam_design::telling_apart(&model, &rival.model, &rig, &progress)?,
        None => socam_design::sharpest(&model, &rig, &recorded, &progress)?,
    };
    let reference = match rival {
        Some(_) => None,
        None => socam_design::foretell(&rig, &model, &recorded, &five_steps(&rig.limits()))?
            .map(|(_, widths)| widths),
    };
    bar.finish_and_clear();
    let tells_apart = rival.map(|rival| rival.names);
    let profile = design.profile(&model.name, tells_apart.as_ref()).to_toml();
    if let Some(mut target) = target {
        target.write_all(profile.as_bytes())?;
        target.commit()?;
    }
    if args.json {
        output::print_json(&Document::new(&design, profile, tells_apart, reference.as_deref()))?;
    } else {
        output::print(&text(
            &design,
            tells_apart.as_ref(),
            reference.as_deref(),
            args.output.as_deref(),
            &profile,
        ))?;
    }
    Ok(Outcome::on(&recorded))
}

fn models(args: &Args, base: Model) -> anyhow::Result<(Model, Option<Rival>)> {
    if let Some(name) = &args.rival {
        let model = model_file::load(name)?;
        return Ok((base, Some(Rival { model, names: [args.model.clone(), name.clone()] })));
    }
    let Some(path) = &args.diagnosis else { return Ok((base, None)) };
    let (found, rival) = rival::of_diagnosis(&base, path)?;
    Ok((found, Some(rival)))
}

fn rig(args: &Args, model: &Model) -> anyhow::Result<Rig> {
    let mut calibration = match &args.calibration {
        Some(path) => Calibration::open(path)?,
        None => calibration_for(model),
    };
    for text in &args.limit {
        let names: Vec<&str> = calibration.channels.iter().map(|c| c.channel.name.as_str()).collect();
        let wrong = || {
            WrongArguments(format!(
                "--limit {text}: expected CHANNEL=VALUE with one of {} and a positive number",
                names.join(", ")
            ))
        };
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let value: f64 =
            value.parse().ok().filter(|value: &f64| *value > 0.0 && value.is_finite()).ok_or_else(wrong)?;
        let index = names.iter().position(|known| *known == name).ok_or_else(wrong)?;
        calibration.channels[index].limit = Some(value);
    }
    let limits = Limits {
        voltage: args.voltage.unwrap_or(USUAL_V.min(calibration.clamp_v)),
        slew_v_s: args.slew,
        duration_s: args.duration,
        one_way: args.one_way,
    };
    let truth = Truth::new(model, &[], &[])?;
    let rig = Rig::new(Setup::new(truth, calibration, 1), limits);
    rig.map_err(|error| WrongArguments(error.to_string()).into())
}
