//! The result of a recording of a device that is not the own board: in words, as JSON and as exit code.

use std::path::Path;

use serde::Serialize;
use socam_sources::ClockMap;

use super::summary::{Summary, ended_early};
use crate::commands::Outcome;
use crate::device::lost_words;
use crate::device::source::{SourceEnd, SourceReport};
use crate::output;

/// Drift of a device's clock beyond which a warning says so; crystals stay below a tenth of it.
const DRIFT: f64 = 1e-3;

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    summary: Summary,
    repeated: u64,
    late: u64,
    damaged: u64,
    clock_jumps: u64,
    interruptions: u64,
    strangers: u64,
    bytes: u64,
    duration_s: f64,
    end: &'static str,
    reason: Option<&'a str>,
    lost_counted: &'a str,
    clock: Option<Clock>,
    arrival_spread_s: f64,
}

/// The device's clock against the host's.
#[derive(Serialize)]
struct Clock {
    drift_1: f64,
    uncertainty_s: f64,
    latest_s: f64,
    compared_s: f64,
}

impl From<ClockMap> for Clock {
    fn from(map: ClockMap) -> Self {
        Self {
            drift_1: map.drift,
            uncertainty_s: map.uncertainty_s,
            latest_s: map.latest_s,
            compared_s: map.over_s,
        }
    }
}

pub(super) fn tell(path: &Path, report: &SourceReport, is_commanded: bool, json: bool) -> anyhow::Result<()> {
    let (end, reason) = match &report.end {
        SourceEnd::Finished => ("finished", None),
        SourceEnd::Stopped => ("stopped", None),
        SourceEnd::Gone(reason) => ("link broken", Some(reason.as_str())),
        SourceEnd::Ended(reason) => ("fault", Some(reason.as_str())),
    };
    let (summary, counts) = (&report.summary, &report.counts);
    if let Some(map) = report.clock.filter(|map| map.drift.abs() > DRIFT) {
        output::warn(format_args!(
            "the device's clock ran {:+.2} % against this computer's, more than a crystal does: speeds by it are wrong by as much, unless this computer's clock is",
            100.0 * map.drift
        ));
    }
    if json {
        return output::print_json(&Document {
            summary: Summary::of(path, summary),
            repeated: counts.repeated,
            late: counts.late,
            damaged: counts.damaged,
            clock_jumps: counts.jumps,
            interruptions: report.interruptions,
            strangers: report.strangers,
            bytes: summary.bytes,
            duration_s: report.duration_s,
            end,
            reason,
            lost_counted: &report.counted_by,
            clock: report.clock.map(Clock::from),
            arrival_spread_s: report.arrival_spread_s,
        });
    }
    output::print(&text(path, report, is_commanded))
}

/// The result in words: `run.mcap: 5000 samples over 5.000 s, none lost (counted by ...); 2 damaged messages`.
pub(crate) fn text(path: &Path, report: &SourceReport, is_commanded: bool) -> String {
    let (summary, counts) = (&report.summary, &report.counts);
    let lost = lost_words(summary.lost);
    let mut text = format!(
        "{}: {} samples over {:.3} s, {lost} (counted {})",
        path.display(),
        summary.written,
        report.duration_s,
        report.counted_by
    );
    for (count, what) in [
        (counts.damaged, "damaged messages"),
        (counts.repeated, "repeated"),
        (counts.late, "late ones left out"),
        (counts.jumps, "jumps of the device's clock"),
        (report.interruptions, "interruptions of the link"),
        (report.strangers, "packets of other senders left out"),
    ] {
        if count > 0 {
            text.push_str(&format!(", {count} {what}"));
        }
    }
    if report.end == SourceEnd::Stopped {
        text.push_str(", stopped by the operator");
    }
    let clock = match &report.clock {
        Some(map) => format!(
            "times by the device's clock, which ran {:+.1} ppm against this computer's within {:.3} ms over {:.1} s",
            map.drift * 1e6,
            map.uncertainty_s * 1e3,
            map.over_s
        ),
        None if is_commanded => {
            format!(
                "times are those at which commands left; answers came within {:.1} ms",
                report.arrival_spread_s * 1e3
            )
        }
        None if report.arrival_spread_s > 0.0 => {
            format!("times are those of arrival, within {:.1} ms", report.arrival_spread_s * 1e3)
        }
        None => "the clocks were compared for too short a time to say more".to_owned(),
    };
    text.push_str(&format!("\n{clock}\n"));
    text
}

pub(super) fn outcome(path: &Path, report: &SourceReport) -> anyhow::Result<Outcome> {
    match &report.end {
        SourceEnd::Gone(reason) | SourceEnd::Ended(reason) => anyhow::bail!(ended_early(reason, path)),
        _ if report.summary.lost > 0 => Ok(Outcome::LostSamples),
        _ => Ok(Outcome::Done),
    }
}
