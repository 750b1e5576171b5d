//! Summary of the rows of a fleet, schema `socam.fleet-summary/1`.
//!
//! Three lists are made, each at the stated false discovery rate: machines that lack physics (by the p-values of the screening), trends
//! of parameters, and machines that differ from their sisters.

mod parameters;
mod survey;

use std::collections::BTreeSet;

use serde::Serialize;

pub use self::survey::{Machine, Survey};
use crate::collected::{Counts, Member, Trouble};
use crate::error::Result;
use crate::row::Row;

/// Version of [`Summary`]'s JSON form.
pub const SUMMARY_SCHEMA: &str = "socam.fleet-summary/1";

/// Summary of the rows of a fleet.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// [`SUMMARY_SCHEMA`].
    pub schema: &'static str,
    /// False discovery rate of each list, 1.
    pub fdr: f64,
    /// Counts of recordings.
    pub counts: Counts,
    /// Number of machines.
    pub machines: usize,
    /// Machines that stand out in the screening by something that matters, the smallest p-value first.
    pub faulty: Vec<Faulty>,
    /// Findings of these machines by effect and place, those on the most machines first.
    pub groups: Vec<Group>,
    /// Number of findings on machines that are not listed; these may be due to chance.
    pub by_chance: usize,
    /// Parameters that change over the dates, the smallest p-value first.
    pub trends: Vec<Trend>,
    /// Number of trends that were tested.
    pub trends_tested: usize,
    /// Machines that differ from their sisters, the smallest p-value first.
    pub differences: Vec<Different>,
    /// Number of differences that were tested.
    pub differences_tested: usize,
    /// Spread of each parameter over the fleet.
    pub parameters: Vec<Spread>,
    /// Parameters that no recording determines: no change of them can be detected.
    pub undetermined: Vec<String>,
    /// Recordings without a verdict, the first thousand.
    pub troubles: Vec<Trouble>,
}

/// A machine that stands out in the screening.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Faulty {
    /// Machine.
    pub machine: String,
    /// Number of recordings of the machine.
    pub recordings: u64,
    /// p-value over its recordings.
    pub p_value: f64,
    /// The smallest false discovery rate at which it is listed.
    pub q_value: f64,
    /// Missing effects, as `EFFECT@PLACE`; empty if the machine stands out but no material effect was found.
    pub findings: Vec<String>,
}

/// Findings of one effect at one place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// Id in the catalogue, or `unexplained`.
    pub effect: String,
    /// Place or channel.
    pub place: String,
    /// The parameter that is its size.
    pub parameter: Option<String>,
    /// Unit of the size.
    pub unit: String,
    /// Number of machines.
    pub machines: usize,
    /// Median of the sizes.
    pub median: Option<f64>,
    /// Findings of the group, by machine and date.
    pub members: Vec<Member>,
}

/// A parameter of a machine that changes over the dates.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trend {
    /// Machine.
    pub machine: String,
    /// Parameter.
    pub parameter: String,
    /// Unit of the parameter.
    pub unit: String,
    /// Recordings with a date and an estimate.
    pub recordings: usize,
    /// Change per year, in the unit.
    pub per_year: f64,
    /// 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Change from the first date to the last, as a share of the value in the middle, 1.
    pub change: f64,
    /// p-value.
    pub p_value: f64,
    /// The smallest false discovery rate at which it is listed.
    pub q_value: f64,
}

/// A machine that differs from its sisters in a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Different {
    /// Machine.
    pub machine: String,
    /// Parameter.
    pub parameter: String,
    /// Unit of the parameter.
    pub unit: String,
    /// Mean of its recordings.
    pub value: f64,
    /// Standard error of the mean.
    pub std: f64,
    /// Median of the sisters.
    pub median: f64,
    /// Standard deviation between them.
    pub between_std: f64,
    /// Distance in standard deviations.
    pub z: f64,
    /// p-value.
    pub p_value: f64,
    /// The smallest false discovery rate at which it is listed.
    pub q_value: f64,
}

/// Spread of a parameter over the fleet.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// Parameter.
    pub parameter: String,
    /// Unit of the parameter.
    pub unit: String,
    /// Machines with an estimate.
    pub machines: usize,
    /// Median over machines.
    pub median: f64,
    /// Standard deviation between machines without measurement errors; `None` if there are few machines.
    pub between_std: Option<f64>,
    /// Scatter of a machine about its own trend line, divided by the scatter that the intervals predict (a ratio of standard
    /// deviations); at least 1.
    pub repeatability: f64,
    /// The change from the first date to the last that would be listed with a probability of 80 %, as a share of the value: median over
    /// machines. `None` without dates.
    pub detectable_change: Option<f64>,
}

impl Summary {
    /// Summary of all rows at a false discovery rate.
    ///
    /// # Errors
    /// When a row cannot be read.
    pub fn of(rows: impl Iterator<Item = Result<Row>>, fdr: f64) -> Result<Self> {
        Ok(Survey::of(rows, fdr)?.at(fdr))
    }

    /// Machines of all three lists.
    #[must_use]
    pub fn notable(&self) -> BTreeSet<&str> {
        let faulty = self.faulty.iter().map(|one| one.machine.as_str());
        let trends = self.trends.iter().map(|one| one.machine.as_str());
        faulty.chain(trends).chain(self.differences.iter().map(|one| one.machine.as_str())).collect()
    }
}
