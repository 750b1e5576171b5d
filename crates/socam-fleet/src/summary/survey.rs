//! All tests of a fleet, of which a [`Summary`] at any false discovery rate is a choice.

use std::collections::{BTreeMap, BTreeSet};

use super::parameters::{Parameters, parameters};
use super::{Different, Faulty, Group, SUMMARY_SCHEMA, Spread, Summary, Trend};
use crate::collected::{Collected, Counts, Found, Known, Trouble};
use crate::error::Result;
use crate::row::Row;
use crate::statistics::{
    discovery::{adjusted, simes},
    median,
    trend::Sensitivity,
};

/// Results of all tests over the rows of a fleet, before a false discovery rate is chosen.
#[derive(Debug, Clone)]
pub struct Survey {
    /// Counts of recordings.
    pub counts: Counts,
    /// All machines, by name.
    pub machines: Vec<Machine>,
    parameters: Vec<Spread>,
    undetermined: Vec<String>,
    /// Sensitivities by parameter, in the order of `parameters`.
    sensitivities: Vec<Option<Sensitivity>>,
    found: BTreeMap<(String, String), Found>,
    trends: Vec<Trend>,
    trends_tested: usize,
    differences: Vec<Different>,
    differences_tested: usize,
    troubles: Vec<Trouble>,
}

/// A machine of the fleet.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Name of the machine.
    pub name: String,
    /// Counts of the machine's recordings.
    pub counts: Counts,
    /// p-value over its recordings, and the smallest false discovery rate at which it is listed; `None` where none was screened.
    pub p_and_q: Option<(f64, f64)>,
    /// Whether an effect or residual that stands out in the machine is material; a machine without one is not listed.
    pub is_material: bool,
    /// Effects found in any of the machine's recordings, as `EFFECT@PLACE`.
    pub findings: Vec<String>,
}

impl Survey {
    /// Survey of all rows. Trends and differences are kept if they are listed at the rate `most_fdr`.
    ///
    /// # Errors
    /// When a row cannot be read.
    pub fn of(rows: impl Iterator<Item = Result<Row>>, most_fdr: f64) -> Result<Self> {
        let all = Collected::of(rows)?;
        let Parameters { trends, differences, spreads, undetermined, sensitivities } = parameters(&all);
        let (trends_tested, differences_tested) = (trends.len(), differences.len());
        Ok(Self {
            counts: all.counts,
            machines: machines(all.machines),
            parameters: spreads,
            undetermined,
            sensitivities,
            found: all.found,
            trends: discoveries(trends, most_fdr, |one| (&mut one.q_value, one.p_value)),
            trends_tested,
            differences: discoveries(differences, most_fdr, |one| (&mut one.q_value, one.p_value)),
            differences_tested,
            troubles: all.troubles,
        })
    }

    /// Summary at the false discovery rate `fdr`, which must not exceed that of [`Self::of`].
    #[must_use]
    pub fn at(&self, fdr: f64) -> Summary {
        let faulty = self.faulty(fdr);
        let listed: BTreeSet<&str> = faulty.iter().map(|one| one.machine.as_str()).collect();
        let total: usize = self.found.values().map(|group| group.members.len()).sum();
        let mut groups: Vec<Group> =
            self.found.iter().filter_map(|(key, group)| grouped(key, group, &listed)).collect();
        groups.sort_by(|a, b| b.machines.cmp(&a.machines).then(a.effect.cmp(&b.effect)));
        let by_chance = total - groups.iter().map(|group| group.members.len()).sum::<usize>();
        Summary {
            schema: SUMMARY_SCHEMA,
            fdr,
            counts: self.counts.clone(),
            machines: self.machines.len(),
            faulty,
            groups,
            by_chance,
            trends: self.trends.iter().filter(|one| one.q_value <= fdr).cloned().collect(),
            trends_tested: self.trends_tested,
            differences: self.differences.iter().filter(|one| one.q_value <= fdr).cloned().collect(),
            differences_tested: self.differences_tested,
            parameters: self.parameters(fdr),
            undetermined: self.undetermined.clone(),
            troubles: self.troubles.clone(),
        }
    }

    /// Spread of each parameter, with the smallest change that would be listed at `fdr`.
    #[must_use]
    pub fn parameters(&self, fdr: f64) -> Vec<Spread> {
        // Threshold of the p-value if only one machine is in the list.
        let p_value = fdr / self.trends_tested.max(1) as f64;
        let each = self.parameters.iter().zip(&self.sensitivities);
        each.map(|(spread, known)| Spread {
            detectable_change: known.and_then(|known| known.detectable(p_value)),
            ..spread.clone()
        })
        .collect()
    }

    fn faulty(&self, fdr: f64) -> Vec<Faulty> {
        let listed = self.machines.iter().filter(|machine| machine.is_material).filter_map(|machine| {
            let (p_value, q_value) = machine.p_and_q.filter(|(_, q)| *q <= fdr)?;
            Some(Faulty {
                machine: machine.name.clone(),
                recordings: machine.counts.recordings,
                p_value,
                q_value,
                findings: machine.findings.clone(),
            })
        });
        let mut listed: Vec<Faulty> = listed.collect();
        listed.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
        listed
    }
}

fn machines(known: BTreeMap<String, Known>) -> Vec<Machine> {
    let screened = known.values().filter(|known| !known.p_values.is_empty());
    let p_values: Vec<f64> = screened.map(|known| simes(&known.p_values)).collect();
    let mut tests = p_values.iter().copied().zip(adjusted(&p_values));
    let each = known.into_iter().map(|(name, known)| Machine {
        name,
        p_and_q: if known.p_values.is_empty() { None } else { tests.next() },
        is_material: known.is_material,
        counts: known.counts,
        findings: known.findings.into_iter().collect(),
    });
    each.collect()
}

/// Sets the adjusted p-values and keeps the discoveries, the smallest p-value first.
fn discoveries<T>(mut all: Vec<T>, fdr: f64, parts: impl Fn(&mut T) -> (&mut f64, f64)) -> Vec<T> {
    let p_values: Vec<f64> = all.iter_mut().map(|one| parts(one).1).collect();
    for (one, q) in all.iter_mut().zip(adjusted(&p_values)) {
        *parts(one).0 = q;
    }
    let mut kept: Vec<(f64, T)> = p_values
        .into_iter()
        .zip(all)
        .filter_map(|(p, mut one)| (*parts(&mut one).0 <= fdr).then_some((p, one)))
        .collect();
    kept.sort_by(|a, b| a.0.total_cmp(&b.0));
    kept.into_iter().map(|(_, one)| one).collect()
}

/// Findings of machines that are listed; `None` if there are none.
fn grouped((effect, place): &(String, String), found: &Found, listed: &BTreeSet<&str>) -> Option<Group> {
    let own = found.members.iter().filter(|member| listed.contains(member.machine.as_str()));
    let mut members: Vec<_> = own.cloned().collect();
    members.sort_by(|a, b| (&a.machine, a.date, &a.recording).cmp(&(&b.machine, b.date, &b.recording)));
    let machines: BTreeSet<&str> = members.iter().map(|member| member.machine.as_str()).collect();
    let machines = machines.len();
    let mut sizes: Vec<f64> = members.iter().filter_map(|member| member.size).collect();
    let median = Some(median(&mut sizes)).filter(|median| median.is_finite());
    (machines > 0).then(|| Group {
        effect: effect.clone(),
        place: place.clone(),
        parameter: found.parameter.clone(),
        unit: found.unit.clone(),
        machines,
        median,
        members,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::tests::full;
    use crate::row::{Status, Verdict};

    /// One survey gives the lists of every rate, and each is what a summary made at that rate has.
    #[test]
    fn a_survey_lists_at_any_rate_what_a_summary_of_that_rate_lists() {
        let rows: Vec<Row> = (0..60_u32)
            .map(|number| Row {
                recording: format!("SN{:02}/{number}", number / 3),
                machine: Some(format!("SN{:02}", number / 3)),
                date: Some(86_400_000 * i64::from(number % 3) * 30),
                p_value: (number >= 3).then(|| 1e-4 * f64::from(number).powi(2)),
                status: if number < 3 { Status::Unfit } else { Status::Ok },
                verdict: (number >= 3).then_some(Verdict::MissingPhysics),
                ..full()
            })
            .collect();
        let all = || rows.iter().cloned().map(Ok);
        let survey = Survey::of(all(), 0.5).unwrap();
        let mut lengths = BTreeSet::new();
        for fdr in [0.01, 0.05, 0.5] {
            let (own, other) = (survey.at(fdr), Summary::of(all(), fdr).unwrap());
            assert_eq!(serde_json::to_string(&own).unwrap(), serde_json::to_string(&other).unwrap());
            lengths.insert(own.faulty.len());
        }
        assert_eq!(lengths.len(), 3, "{lengths:?}");
        let first = &survey.machines[0];
        assert_eq!((first.counts.unfit, first.counts.adequate, first.p_and_q), (3, 0, None));
        assert_eq!(survey.machines[1].counts.missing_physics, 3);
        assert_eq!(survey.machines[1].findings, ["an_effect@load"]);
    }
}
