//! The result of a run in words, as JSON and as exit code.

use serde::Serialize;

use super::summary::{Summary, ended_early};
use crate::commands::Outcome;
use crate::device::lost_words;
use crate::device::run::{End, Report};
use crate::output;

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    summary: Summary,
    bytes: u64,
    duration_s: f64,
    rate_hz: f64,
    end: &'static str,
    reason: Option<&'a str>,
    enable_read_back: String,
}

/// Prints the result of a run.
pub(crate) fn tell(path: &std::path::Path, report: &Report, rate_hz: f64, json: bool) -> anyhow::Result<()> {
    let summary = &report.summary;
    let (end, reason) = match &report.end {
        End::Finished => ("finished", None),
        End::Stopped => ("stopped", None),
        End::Fault(reason) => ("fault", Some(reason.as_str())),
        End::Broken(reason) => ("link broken", Some(reason.as_str())),
    };
    if json {
        return output::print_json(&Document {
            summary: Summary::of(path, summary),
            bytes: summary.bytes,
            duration_s: report.duration_s,
            rate_hz,
            end,
            reason,
            enable_read_back: report.enable_feedback.to_string(),
        });
    }
    let lost = lost_words(summary.lost);
    output::print(&format!(
        "{}: {} samples over {:.3} s at {rate_hz} Hz, {lost}{}\n",
        path.display(),
        summary.written,
        report.duration_s,
        if report.end == End::Stopped { ", stopped by the operator" } else { "" },
    ))
}

/// The outcome of a run, which determines the exit code.
pub(crate) fn outcome(path: &std::path::Path, report: &Report) -> anyhow::Result<Outcome> {
    match &report.end {
        End::Fault(reason) => {
            anyhow::bail!(ended_early(format_args!("the board ended the run: {reason}"), path))
        }
        End::Broken(reason) => anyhow::bail!(ended_early(reason, path)),
        End::Finished | End::Stopped if report.summary.lost > 0 => Ok(Outcome::LostSamples),
        End::Finished | End::Stopped => Ok(Outcome::Done),
    }
}
