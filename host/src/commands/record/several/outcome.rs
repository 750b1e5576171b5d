//! The result of a recording of several devices: in words, as JSON and as exit code.

use std::path::Path;

use serde::Serialize;

use super::attended::Attended;
use super::file::Made;
use crate::commands::Outcome;
use crate::commands::record::summary::{Summary, ended_early};
use crate::device::lost_words;
use crate::output;

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    summary: Summary,
    bytes: u64,
    duration_s: f64,
    end: &'static str,
    reason: Option<&'a str>,
    devices: Vec<Device<'a>>,
}

/// A device of the recording.
#[derive(Serialize)]
struct Device<'a> {
    name: &'a str,
    address: &'a str,
    rows: u64,
    lost: u64,
    repeated: u64,
    late: u64,
    damaged: u64,
    clock_jumps: u64,
    interruptions: u64,
    strangers: u64,
    lost_counted: &'a str,
    /// Whether its times are those of its own clock.
    has_clock: bool,
    /// Uncertainty of its times on this computer's clock, beside the constant delay of its link, s.
    uncertainty_s: f64,
}

/// Prints the result. `uncertain`: uncertainty of the times of devices with a clock, s.
pub(super) fn tell(
    path: &Path,
    made: &Made,
    labels: &[String],
    attended: &[Attended],
    uncertain: &[Option<f64>],
    json: bool,
) -> anyhow::Result<()> {
    let devices: Vec<Device<'_>> = attended
        .iter()
        .zip(labels)
        .zip(uncertain)
        .map(|((own, name), uncertain)| Device {
            name,
            address: &own.address,
            rows: own.rows,
            lost: own.lost,
            repeated: own.counts.repeated,
            late: own.counts.late,
            damaged: own.counts.damaged,
            clock_jumps: own.counts.jumps,
            interruptions: own.interruptions,
            strangers: own.strangers,
            lost_counted: &own.counted_by,
            has_clock: uncertain.is_some(),
            uncertainty_s: uncertain.unwrap_or(own.arrival_spread_s),
        })
        .collect();
    let summary = &made.summary;
    if json {
        let (end, reason) = match &made.gone {
            Some(reason) => ("link broken", Some(reason.as_str())),
            None if made.is_stopped => ("stopped", None),
            None => ("finished", None),
        };
        return output::print_json(&Document {
            summary: Summary::of(path, summary),
            bytes: summary.bytes,
            duration_s: made.duration_s,
            end,
            reason,
            devices,
        });
    }
    let mut text = format!(
        "{}: {} samples over {:.3} s, {}{}\n",
        path.display(),
        summary.written,
        made.duration_s,
        lost_words(summary.lost),
        if made.is_stopped { ", stopped by the operator" } else { "" }
    );
    devices.iter().for_each(|device| text.push_str(&line(device)));
    text.push_str(
        "the constant delay of each link is not known, and shifts the devices against each other\n",
    );
    output::print(&text)
}

/// `  moteus1: 5000 rows, none lost (counted ...), times of arrival within 1.2 ms`
fn line(device: &Device<'_>) -> String {
    let lost = lost_words(device.lost);
    let times = if device.has_clock { "times by its clock, on this computer's" } else { "times of arrival" };
    let others = [
        (device.damaged, "damaged"),
        (device.repeated, "repeated"),
        (device.late, "late"),
        (device.clock_jumps, "jumps of its clock"),
        (device.interruptions, "interruptions"),
        (device.strangers, "packets of other senders left out"),
    ];
    let others =
        others.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!(", {count} {what}"));
    format!(
        "  {}: {} rows, {lost} (counted {}){}, {times} within {:.1} ms\n",
        device.name,
        device.rows,
        device.lost_counted,
        others.collect::<String>(),
        device.uncertainty_s * 1e3
    )
}

/// The exit code.
pub(super) fn of(path: &Path, made: &Made, attended: &[Attended]) -> anyhow::Result<Outcome> {
    if let Some(reason) = &made.gone {
        anyhow::bail!(ended_early(reason, path));
    }
    let is_whole = made.summary.lost == 0 && attended.iter().all(|device| device.lost == 0);
    Ok(if is_whole { Outcome::Done } else { Outcome::LostSamples })
}
