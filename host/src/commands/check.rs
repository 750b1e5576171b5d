//! `check`: whether recordings can carry a fit, before any fit.

use std::fmt::Write;

use anyhow::bail;
use socam_model::Model;
use socam_recording::check::{ChannelCheck, Check, CheckOptions, Document, Severity, Verdict, check};
use socam_recording::{Channel, Dataset};

use super::Outcome;
use crate::output::{self, WrongArguments};
use crate::{model_file, table};

/// Check whether recordings are fit for identification, what is wrong, and what to record instead
///
/// Checks the channels of the model: excitation of the input in amplitude, over frequency and near the model's resonances; speed ratios;
/// saturated, stuck, noisy or humming sensors; missing rows. Findings are results: the exit code is 0 even if a recording is not fit for use, and 3 if samples of it are missing.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host check RUN.mcap
  socam-host check RUN.mcap@2..10                     only from 2 s to 10 s
  socam-host check axis.csv --model emps              a servo axis, driven by a force
  socam-host check anything.csv --input voltage       without a model")]
pub(crate) struct Args {
    /// Recordings (.mcap, .csv or .m), or parts of them: RUN@FROM..TO in seconds
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = model_file::HELP)]
    model: String,
    /// Check all channels without a model; this channel is the input
    #[arg(long, value_name = "CHANNEL", conflicts_with = "model")]
    input: Option<String>,
    /// Tolerance of the mean ratio of two speeds against that of the gears, percent
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0, allow_hyphen_values = true)]
    ratio_tolerance: f64,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    if !(0.0..=100.0).contains(&args.ratio_tolerance) {
        let problem = format!("--ratio-tolerance is {} %; expected 0 to 100", args.ratio_tolerance);
        return Err(WrongArguments(problem).into());
    }
    let model = match args.input {
        Some(_) => None,
        None => Some(model_file::load(&args.model)?),
    };
    let options = match &model {
        Some(model) => socam_expectation::of_model(model, args.ratio_tolerance / 100.0),
        None => CheckOptions { input: args.input.clone(), ..CheckOptions::default() },
    };
    let mut outcome = Outcome::Done;
    let check_one = |run: &String| {
        let data = output::open_regular(run)?;
        if let Some(model) = &model {
            require_common_ground(&data, model)?;
        }
        if Outcome::on([&data]) == Outcome::LostSamples {
            outcome = Outcome::LostSamples;
        }
        Ok(check(&data, &options)?)
    };
    let checks = args.runs.iter().map(check_one).collect::<anyhow::Result<Vec<_>>>()?;
    if args.json {
        output::print_json(&Document::new(&checks))?;
    } else {
        let texts: Vec<String> = checks.iter().map(text).collect();
        output::print(&texts.join("\n"))?;
    }
    Ok(outcome)
}

/// A recording with none of the model's channels is one of another bench.
fn require_common_ground(data: &Dataset, model: &Model) -> anyhow::Result<()> {
    if model.channels.iter().any(|channel| data.channel_index(&channel.column).is_ok()) {
        return Ok(());
    }
    let read: Vec<&str> = model.channels.iter().map(|channel| channel.column.as_str()).collect();
    let held: Vec<String> = data.channels().iter().map(Channel::column_name).collect();
    bail!(
        "`{}` has none of the channels that the model {} reads ({}); it has {}; name its model with --model, or its input with \
         --input",
        data.name(),
        model.name,
        read.join(", "),
        held.join(", ")
    )
}

fn text(check: &Check) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_text(&mut out, check);
    out
}

fn write_text(out: &mut String, check: &Check) -> std::fmt::Result {
    let verdict = match check.verdict {
        Verdict::Fit => "fit for use",
        Verdict::FitWithReservations => "fit for use, with reservations",
        Verdict::Unfit => "not fit for use",
    };
    writeln!(out, "{}: {verdict}", check.recording)?;
    let head = [
        "channel",
        "unit",
        "amplitude",
        "signal/noise",
        "band",
        "frequencies",
        "steps",
        "turns",
        "sign changes",
        "",
    ];
    let dash = || "-".to_owned();
    let row = |channel: &ChannelCheck| {
        vec![
            channel.name.clone(),
            channel.unit.symbol().to_owned(),
            table::number(channel.amplitude),
            channel.snr_db.map_or_else(dash, |snr| format!("{snr:.1} dB")),
            channel.band_hz.map_or_else(dash, |[from, to]| format!("{from:.2} to {to:.2} Hz")),
            channel.lines.map_or_else(dash, |lines| lines.to_string()),
            channel.steps.to_string(),
            channel.turning_points.to_string(),
            channel.sign_changes.to_string(),
            if check.input.as_ref() == Some(&channel.name) { "input".to_owned() } else { String::new() },
        ]
    };
    let rows: Vec<_> =
        std::iter::once(head.map(str::to_owned).to_vec()).chain(check.channels.iter().map(row)).collect();
    out.push_str(&table::align(&rows, &[false, false, true, true, true, true, true, true, true, false]));
    for finding in &check.findings {
        let severity = match finding.severity() {
            Severity::Prevents => "prevents a fit",
            Severity::Weakens => "weakens a fit",
            Severity::Note => "note",
        };
        writeln!(out, "  {severity}: {}", finding.sentence())?;
        writeln!(out, "    instead: {}", finding.remedy())?;
    }
    Ok(())
}
