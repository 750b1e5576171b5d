//! Verification of X. Song, *The Parameter Identification of a Novel Speed Reducer*, McGill University, 2002: every number is computed
//! again from its own data.
//!
//! The printed numbers are in `thesis.toml`. [`examine`] computes them again.

mod data;
mod efficiency;
mod hardware;
mod matching;
mod printed;
mod report;
mod transfer;

pub use data::{Thesis, thesis};
pub use printed::Printed;
pub use report::{Point, Report, Row, SCHEMA, Table, Verdict, short};

/// Computes everything again.
///
/// # Errors
/// When the embedded data cannot be read; one sentence.
pub fn examine() -> Result<Report, String> {
    let thesis = thesis()?;
    let mut report = Report::new();
    hardware::examine(&thesis, &mut report);
    transfer::examine(&thesis, &mut report);
    matching::examine(&thesis, &mut report);
    efficiency::examine(&thesis, &mut report);
    report.points.sort_by_key(|point| point.number);
    Ok(report)
}

#[cfg(test)]
mod tests;
