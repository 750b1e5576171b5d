//! `check`: whether recordings are suitable for a fit.

use std::fmt::Write;

use socam_job::{Grid, Settings};
use socam_recording::check::{ChannelCheck, Check, Document, Severity, Verdict};

use super::Outcome;
use crate::rules::{self, Kept, RulesArgs, WithRules};
use crate::{output, table};

/// Check whether recordings are fit for identification, what is wrong, and what to record instead
///
/// Checks the channels of the model: excitation of the input in amplitude, over frequency and near the model's resonances; speed ratios;
/// saturated, stuck, noisy or humming sensors; missing rows. Findings are results: the exit code is 0 even if a recording is not fit for use, 3 if samples of it are missing, and 4 if a rule of `--rules` is broken.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host check RUN.mcap
  socam-host check RUN.mcap@2..10                     only from 2 s to 10 s
  socam-host check axis.csv --model emps              a servo axis, driven by a force
  socam-host check anything.csv --input voltage       without a model
  socam-host check RUN.mcap --rules limits.toml       also by rules of your own, for a nightly job")]
pub(crate) struct Args {
    #[arg(value_name = "RUN", required = true, help = output::RUNS_HELP)]
    runs: Vec<String>,
    #[command(flatten)]
    task: socam_job::Check,
    #[command(flatten)]
    rules: RulesArgs,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(mut args: Args) -> anyhow::Result<Outcome> {
    args.runs = output::expanded(&args.runs)?;
    args.task.validate()?;
    let model = args.task.load()?;
    model.iter().flat_map(socam_model::Model::warnings).for_each(output::warn);
    let rules = args.rules.read()?;
    let mut kept = Vec::new();
    let mut outcome = Outcome::Done;
    let check_one = |run: &String| {
        let data = output::open_on(Grid::View, run)?;
        if Outcome::on([&data]) == Outcome::LostSamples {
            outcome = Outcome::LostSamples;
        }
        kept.extend(rules::judge(rules.as_ref(), &data)?);
        Ok(args.task.run(model.as_ref(), &data)?)
    };
    let checks = args.runs.iter().map(check_one).collect::<anyhow::Result<Vec<_>>>()?;
    if kept.iter().any(|kept| !kept.is_kept()) {
        outcome = Outcome::RuleBroken;
    }
    if args.json {
        output::print_json(&WithRules { document: Document::new(&checks), rules: kept })?;
    } else {
        let of_rules = kept.iter().map(Kept::text).chain(std::iter::repeat_with(String::new));
        let texts: Vec<String> =
            checks.iter().zip(of_rules).map(|(check, rules)| text(check) + &rules).collect();
        output::print(&texts.join("\n"))?;
    }
    Ok(outcome)
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
