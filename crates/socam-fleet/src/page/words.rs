//! Numbers, dates and names as the page writes them.

use jiff::Timestamp;
use socam_plot::{Axis, words};

use crate::row::Status;

/// p-values below this are not told apart.
const SMALLEST_P: f64 = 1e-15;
const DAY_MS: f64 = 86_400_000.0;

pub(super) fn status(status: Status) -> &'static str {
    match status {
        Status::Ok => "ok",
        Status::Unreadable => "unreadable",
        Status::Unfit => "unfit",
        Status::Failed => "failed",
    }
}

/// An id of the page: names may hold anything.
pub(super) fn anchor(machine: &str) -> String {
    let safe =
        |c: char| if c.is_ascii_alphanumeric() { c.to_string() } else { format!("-{:x}", u32::from(c)) };
    format!("machine-{}", machine.chars().map(safe).collect::<String>())
}

/// Half the width of an interval; zero where an end is open.
pub(super) fn half(low: Option<f64>, high: Option<f64>) -> f64 {
    low.zip(high).map_or(0.0, |(low, high)| 0.5 * (high - low))
}

pub(super) fn days(first: i64, date: i64) -> f64 {
    (date - first) as f64 / DAY_MS
}

pub(super) fn dates(first: i64) -> Axis {
    Axis::new(&format!("time since {}", day(first)), "days")
}

pub(super) fn day(date: i64) -> String {
    Timestamp::from_millisecond(date)
        .map_or_else(|_| String::new(), |stamp| stamp.strftime("%Y-%m-%d").to_string())
}

pub(super) fn percent(share: f64) -> String {
    number(100.0 * share)
}

/// A number to four digits.
pub(super) fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => words::minus(&format!("{rounded}")),
        _ => words::minus(&format!("{rounded:e}")),
    }
}

pub(super) fn scientific(p_value: f64) -> String {
    if p_value < SMALLEST_P {
        "< 1e\u{2212}15".into()
    } else if p_value >= 1e-3 {
        number(p_value)
    } else {
        words::minus(&format!("{p_value:.0e}"))
    }
}
