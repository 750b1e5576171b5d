//! Phrases for the results of a fleet, common to its page, the terminal and the window.

use std::collections::BTreeSet;

use jiff::Timestamp;
use socam_plot::words;

use crate::collected::Counts;
use crate::row::{Status, Verdict};
use crate::summary::Summary;

/// p-values below this are not distinguished.
const SMALLEST_P: f64 = 1e-15;
const DAY_MS: f64 = 86_400_000.0;

/// Text for a machine that stands out although no material effect was found in it.
pub const UNNAMED: &str = "no effect named";

/// One line without a full stop: how many machines lack physics, how many parameters change, and how many machines differ.
#[must_use]
pub fn headline(summary: &Summary) -> String {
    let differ: BTreeSet<&str> = summary.differences.iter().map(|one| one.machine.as_str()).collect();
    let parts = [
        (summary.faulty.len(), "machine lacks physics", "machines lack physics"),
        (summary.trends.len(), "parameter changes over the dates", "parameters change over the dates"),
        (differ.len(), "machine differs from its sisters", "machines differ from their sisters"),
    ];
    let present = parts.into_iter().filter(|(count, ..)| *count > 0);
    let said: Vec<String> =
        present.map(|(count, one, several)| counted(count as u64, one, several)).collect();
    match said.is_empty() {
        false => said.join(", "),
        true if summary.counts.without() == summary.counts.recordings => "No recording has a verdict".into(),
        true => "No machine of the fleet stands out".into(),
    }
}

/// `1 machine`, `2 machines`
#[must_use]
pub fn counted(count: u64, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// `12 recordings of 3 machines`
#[must_use]
pub fn size(summary: &Summary) -> String {
    let recordings = counted(summary.counts.recordings, "recording", "recordings");
    format!("{recordings} of {}", counted(summary.machines as u64, "machine", "machines"))
}

/// The kinds of recordings in the order of the bar that shows their shares, each with its number and its words.
#[must_use]
pub fn kinds(counts: &Counts) -> [(u64, &'static str); 4] {
    [
        (counts.adequate, "adequate"),
        (counts.missing_physics, "with missing physics"),
        (counts.unexplained, "unexplained"),
        (counts.without(), "without a verdict"),
    ]
}

/// Sentences on counts that [`kinds`] does not show.
#[must_use]
pub fn besides(summary: &Summary) -> String {
    let counts = &summary.counts;
    let by_chance = match summary.by_chance {
        0 => String::new(),
        count => format!(
            " {} a finding on machines that are not listed: chance makes some.",
            counted(count as u64, "recording has", "recordings have")
        ),
    };
    format!(
        "Without a verdict: {} unreadable, {} unfit, {} failed. {} got the full diagnosis.{by_chance}",
        counts.unreadable, counts.unfit, counts.failed, counts.diagnosed
    )
}

/// Sentence on the false discovery rate of the lists.
#[must_use]
pub fn rate(fdr: f64) -> String {
    format!("Each list holds at most {} % false entries on average", number(100.0 * fdr))
}

/// Sentence on the smallest changes over the dates that the recordings can show; `None` if there is nothing to report.
#[must_use]
pub fn sensitivity(summary: &Summary) -> Option<String> {
    let listed = summary.parameters.iter().filter_map(|one| {
        Some(format!("{} by {} %", one.parameter, words::rough(100.0 * one.detectable_change?)))
    });
    let listed: Vec<String> = listed.collect();
    let changes = (!listed.is_empty()).then(|| {
        let listed = listed.join(", ");
        format!("Changes from the first date to the last that would be listed with a probability of 80 %: {listed}.")
    });
    let unknown = (!summary.undetermined.is_empty())
        .then(|| format!("No recording determines {}.", summary.undetermined.join(", ")));
    let said: Vec<String> = changes.into_iter().chain(unknown).collect();
    (!said.is_empty()).then(|| said.join(" "))
}

/// Name of a status.
#[must_use]
pub fn status(status: Status) -> &'static str {
    match status {
        Status::Ok => "ok",
        Status::Unreadable => "unreadable",
        Status::Unfit => "unfit",
        Status::Failed => "failed",
    }
}

/// Name of a verdict, or of the status if there is no verdict.
#[must_use]
pub fn verdict(verdict: Option<Verdict>, of: Status) -> &'static str {
    match verdict {
        Some(Verdict::Adequate) => "adequate",
        Some(Verdict::MissingPhysics) => "missing physics",
        Some(Verdict::Unexplained) => "unexplained",
        Some(Verdict::NotJudged) => "not judged",
        None => status(of),
    }
}

/// Days from one date to another, ms since 1970.
#[must_use]
pub fn days(first: i64, date: i64) -> f64 {
    (date - first) as f64 / DAY_MS
}

/// `2026-01-02`, in UTC.
#[must_use]
pub fn day(date: i64) -> String {
    Timestamp::from_millisecond(date)
        .map_or_else(|_| String::new(), |stamp| stamp.strftime("%Y-%m-%d").to_string())
}

/// A number to four digits.
#[must_use]
pub fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => words::minus(&format!("{rounded}")),
        _ => words::minus(&format!("{rounded:e}")),
    }
}

/// A p-value.
#[must_use]
pub fn scientific(p_value: f64) -> String {
    if p_value < SMALLEST_P {
        "< 1e\u{2212}15".into()
    } else if p_value >= 1e-3 {
        number(p_value)
    } else {
        words::minus(&format!("{p_value:.0e}"))
    }
}
