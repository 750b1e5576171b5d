//! `check`: whether recordings can carry a fit, before any fit.

use std::fmt::Write;

use serde::Serialize;
use socam_recording::check::{Check, CheckOptions, FixedRatio, Severity, Verdict, check};

use super::Outcome;
use crate::output;

/// Say whether recordings are fit for use, what stands in the way, and what to record instead
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Recordings (.mcap, .csv or .m), or parts of them: RUN@FROM..TO in seconds
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    /// Channel that drives the model [default: motor_speed, else command]
    #[arg(long, value_name = "CHANNEL")]
    input: Option<String>,
    /// Fixed ratio of the two speeds; 0 leaves it unchecked
    #[arg(long, value_name = "RATIO", default_value_t = 8.0)]
    ratio: f64,
    /// Speed before the reducer
    #[arg(long, value_name = "CHANNEL", default_value = "motor_speed")]
    fast: String,
    /// Speed after the reducer
    #[arg(long, value_name = "CHANNEL", default_value = "output_speed")]
    slow: String,
    /// Deviation of the average ratio that is let pass, percent
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0)]
    ratio_tolerance: f64,
    /// Print one JSON document and nothing else
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let options = CheckOptions {
        input: args.input,
        ratio: (args.ratio != 0.0).then_some(FixedRatio {
            fast: args.fast,
            slow: args.slow,
            ratio: args.ratio,
            tolerance: args.ratio_tolerance / 100.0,
        }),
    };
    let checks = args
        .runs
        .iter()
        .map(|run| Ok(check(&output::open(run)?, &options)?))
        .collect::<anyhow::Result<Vec<_>>>()?;
    if args.json {
        let recordings = checks.iter().map(Described::from).collect();
        output::print_json(&Document { schema: "socam.check/1", recordings })?;
    } else {
        let texts: Vec<String> = checks.iter().map(text).collect();
        output::print(&texts.join("\n"))?;
    }
    Ok(Outcome::Done)
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    recordings: Vec<Described<'a>>,
}

/// A check, with its findings in words beside the numbers.
#[derive(Serialize)]
struct Described<'a> {
    #[serde(flatten)]
    check: &'a Check,
    sentences: Vec<Sentence>,
}

#[derive(Serialize)]
struct Sentence {
    severity: Severity,
    sentence: String,
    remedy: &'static str,
}

impl<'a> From<&'a Check> for Described<'a> {
    fn from(check: &'a Check) -> Self {
        let sentence = |finding: &socam_recording::check::Finding| Sentence {
            severity: finding.severity(),
            sentence: finding.sentence(),
            remedy: finding.remedy(),
        };
        Self { check, sentences: check.findings.iter().map(sentence).collect() }
    }
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
    let width = check.channels.iter().map(|c| c.name.len()).max().unwrap_or(0);
    let width = width.max("channel".len());
    writeln!(
        out,
        "  {:width$}  {:>12} {:6} {:>8} {:>20} {:>6} {:>6} {:>6} {:>6}",
        "channel", "amplitude", "unit", "SNR dB", "band Hz", "lines", "steps", "turns", "signs"
    )?;
    for channel in &check.channels {
        let dash = || "-".to_owned();
        writeln!(
            out,
            "  {:width$}  {:>12.5e} {:6} {:>8} {:>20} {:>6} {:>6} {:>6} {:>6}{}",
            channel.name,
            channel.amplitude,
            channel.unit.symbol(),
            channel.snr_db.map_or_else(dash, |snr| format!("{snr:.1}")),
            channel.band_hz.map_or_else(dash, |[from, to]| format!("{from:.2} to {to:.2}")),
            channel.lines.map_or_else(dash, |lines| lines.to_string()),
            channel.steps,
            channel.turning_points,
            channel.sign_changes,
            if check.input.as_ref() == Some(&channel.name) { "  input" } else { "" },
        )?;
    }
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
