//! The rows of a fleet, kept as small as statistics need them.

use std::collections::{BTreeMap, BTreeSet};

use socam_diagnose::INADEQUATE;

use crate::error::Result;
use crate::row::{Finding, Row, Stage, Status, Verdict};
use crate::statistics::trend::Point;

const DAY_MS: f64 = 86_400_000.0;
/// Largest number of troubles that are kept with their messages.
const MOST_TROUBLES: usize = 1000;

/// Counts of rows.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counts {
    /// All recordings.
    pub recordings: u64,
    /// Recordings whose model is adequate.
    pub adequate: u64,
    /// Recordings in which a known effect is missing from the model.
    pub missing_physics: u64,
    /// Recordings in which something is missing from the model that no known effect explains.
    pub unexplained: u64,
    /// Recordings that cannot be read.
    pub unreadable: u64,
    /// Recordings that this model cannot be fitted to.
    pub unfit: u64,
    /// Recordings whose computation failed.
    pub failed: u64,
    /// Recordings that got the full diagnosis.
    pub diagnosed: u64,
}

impl Counts {
    /// Number of recordings without a verdict.
    #[must_use]
    pub fn without(&self) -> u64 {
        self.unreadable + self.unfit + self.failed
    }

    fn take(&mut self, row: &Row) {
        self.recordings += 1;
        self.diagnosed += u64::from(row.stage == Stage::Diagnosis);
        *match row.status {
            Status::Ok => match row.verdict {
                Some(Verdict::Adequate) | None => &mut self.adequate,
                Some(Verdict::MissingPhysics) => &mut self.missing_physics,
                Some(Verdict::Unexplained) => &mut self.unexplained,
                Some(Verdict::NotJudged) => &mut self.failed,
            },
            Status::Unreadable => &mut self.unreadable,
            Status::Unfit => &mut self.unfit,
            Status::Failed => &mut self.failed,
        } += 1;
    }
}

/// A recording without a verdict.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Trouble {
    /// Name of the recording.
    pub recording: String,
    /// Kind of trouble.
    pub status: Status,
    /// Why.
    pub message: String,
}

/// A finding of one recording.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Member {
    /// Machine.
    pub machine: String,
    /// Recording.
    pub recording: String,
    /// Date, ms since 1970.
    pub date: Option<i64>,
    /// Size, SI.
    pub size: Option<f64>,
    /// 95 % interval.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// Greatest change of a channel, as a share of its standard deviation.
    pub share: Option<f64>,
}

/// Findings of one effect at one place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    pub(crate) parameter: Option<String>,
    pub(crate) unit: String,
    pub(crate) members: Vec<Member>,
}

/// A machine.
#[derive(Debug, Clone, Default)]
pub(crate) struct Known {
    pub(crate) counts: Counts,
    pub(crate) p_values: Vec<f64>,
    /// Whether any recording has a finding or a residual that matters.
    pub(crate) is_material: bool,
    /// Material findings, as `EFFECT@PLACE`.
    pub(crate) findings: BTreeSet<String>,
    /// Estimates by parameter index. The day is NaN if no date is known.
    pub(crate) estimates: BTreeMap<usize, Vec<Point>>,
}

/// All rows.
#[derive(Debug, Clone, Default)]
pub(crate) struct Collected {
    pub(crate) counts: Counts,
    pub(crate) machines: BTreeMap<String, Known>,
    /// Names and units of the parameters that some recording determines, or fails to determine.
    pub(crate) parameters: Vec<(String, String)>,
    /// Findings by effect and place.
    pub(crate) found: BTreeMap<(String, String), Found>,
    pub(crate) troubles: Vec<Trouble>,
}

/// Whether what stands out matters: its diagnosis has a finding or an unexplained rest, or the residual has clearly more power than the
/// noise.
fn is_material(row: &Row) -> bool {
    matches!(row.verdict, Some(Verdict::MissingPhysics | Verdict::Unexplained))
        || row.excess.is_some_and(|excess| excess > INADEQUATE)
}

impl Collected {
    pub(crate) fn of(rows: impl Iterator<Item = Result<Row>>) -> Result<Self> {
        let mut all = Self::default();
        for row in rows {
            all.take(&row?);
        }
        Ok(all)
    }

    fn take(&mut self, row: &Row) {
        self.counts.take(row);
        if row.status != Status::Ok && self.troubles.len() < MOST_TROUBLES {
            let Row { recording, status, message, .. } = row.clone();
            self.troubles.push(Trouble { recording, status, message });
        }
        let parameters: Vec<(usize, Point)> = row
            .parameters
            .iter()
            .filter_map(|own| {
                if own.value.is_none() {
                    self.parameter(&own.name, &own.unit);
                }
                let (value, std) = own.value.filter(|_| own.determined).zip(own.std)?;
                let day = row.date.map_or(f64::NAN, |date| date as f64 / DAY_MS);
                Some((self.parameter(&own.name, &own.unit), Point { day, value, std }))
            })
            .collect();
        let machine = self.machines.entry(row.machine_name().to_owned()).or_default();
        machine.counts.take(row);
        machine.p_values.extend(row.p_value);
        machine.is_material |= is_material(row);
        machine.findings.extend(row.findings.iter().filter(|one| one.material).map(Finding::key));
        for (index, point) in parameters {
            machine.estimates.entry(index).or_default().push(point);
        }
        for finding in row.findings.iter().filter(|finding| finding.material) {
            let key = (finding.effect.clone(), finding.place.clone());
            let group = self.found.entry(key).or_insert_with(|| Found {
                parameter: finding.parameter.clone(),
                unit: finding.unit.clone(),
                members: Vec::new(),
            });
            group.members.push(Member {
                machine: row.machine_name().to_owned(),
                recording: row.recording.clone(),
                date: row.date,
                size: finding.size,
                low: finding.low,
                high: finding.high,
                share: finding.share,
            });
        }
    }

    /// Index of a parameter.
    fn parameter(&mut self, name: &str, unit: &str) -> usize {
        let known = self.parameters.iter().position(|(known, _)| known == name);
        known.unwrap_or_else(|| {
            self.parameters.push((name.to_owned(), unit.to_owned()));
            self.parameters.len() - 1
        })
    }
}
