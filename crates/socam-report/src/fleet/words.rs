//! Ids and axes of the page.

use socam_fleet::words::day;
use socam_plot::Axis;

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

pub(super) fn dates(first: i64) -> Axis {
    Axis::new(&format!("time since {}", day(first)), "days")
}
