//! What an answer is worth, once the truth is known.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use socam_diagnose::document::{Diagnosis, Finding, UNEXPLAINED};
use socam_model::Model;
use socam_sim::challenge::{Case, Hidden, Kind};

use super::oracle::Oracle;
use super::twins::{are_twins, is_place};

pub(super) const SCHEMA: &str = "socam.challenge-case/1";

/// With all findings, curves included, residuals on held-out recordings may be so many times their noise floor.
const AT_THE_FLOOR: f64 = 1.15;

/// An oracle that is told the effect must gain as much in whitened chi-square on the held-out recordings.
pub(super) const DETECTABLE_GAIN: f64 = 25.0;

/// One case, diagnosed and scored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Score {
    pub(super) schema: String,
    pub(super) seed: u64,
    pub(super) number: u64,
    pub(super) kind: Kind,
    pub(super) locked: bool,
    pub(super) hidden: Vec<Hidden>,
    /// What was named, strongest first: effect and location.
    pub(super) named: Vec<(String, String)>,
    /// Why there is no answer.
    pub(super) error: Option<String>,
    /// What an oracle gains by each hidden effect; `None` where it fails.
    pub(super) oracle_gain: Vec<Option<f64>>,
    /// What it leaves, as whitened chi-square per value.
    pub(super) oracle_misfit: Option<f64>,
    /// Whether each of them gains enough to be found.
    pub(super) detectable: bool,
    pub(super) right: bool,
    /// Something is named with confidence that is not there.
    pub(super) wrong_name: bool,
    /// Whether all channels are predicted down to their noise with all findings, curves included; of right answers only.
    pub(super) at_the_floor: Option<bool>,
    /// Whether the intervals hold the truth; of effects named as they are.
    pub(super) intervals: Vec<(String, bool)>,
    /// Processor time of the diagnosis, s.
    pub(super) cpu_s: Option<f64>,
}

impl Score {
    pub(super) fn new(case: &Case, answer: &Result<Diagnosis, String>, oracle: Oracle) -> Self {
        let (answer, error) = match answer {
            Ok(diagnosis) => (Some(diagnosis), None),
            Err(error) => (None, Some(error.clone())),
        };
        let findings = answer.map_or(&[][..], |diagnosis| &diagnosis.findings);
        let right = answer.is_some() && is_right(case, findings);
        Self {
            schema: SCHEMA.into(),
            seed: case.seed,
            number: case.number,
            kind: case.kind,
            locked: case.locked,
            hidden: case.hidden.clone(),
            named: findings.iter().map(|f| (f.effect.clone(), f.location.clone())).collect(),
            error,
            detectable: oracle.gain.iter().all(|gain| gain.is_some_and(|gain| gain >= DETECTABLE_GAIN)),
            oracle_gain: oracle.gain,
            oracle_misfit: oracle.misfit,
            right,
            wrong_name: has_wrong_name(case, findings),
            at_the_floor: answer.filter(|_| right).and_then(at_the_floor),
            intervals: case.hidden.iter().flat_map(|hidden| intervals(hidden, findings)).collect(),
            cpu_s: answer.map(|diagnosis| diagnosis.cpu_s),
        }
    }
}

/// Whether a finding is what was hidden, or a twin of it that owns up to it.
fn is_it(finding: &Finding, hidden: &Hidden) -> bool {
    let named = (&*finding.effect, &*finding.location);
    let truth = (&*hidden.effect, &*hidden.place);
    let owns_up = || finding.rivals.iter().any(|rival| (&*rival.effect, &*rival.location) == truth);
    named == truth || (are_twins(named, truth) && owns_up())
}

fn is_right(case: &Case, findings: &[Finding]) -> bool {
    match case.kind {
        Kind::Clean => findings.is_empty(),
        Kind::Single => findings.first().is_some_and(|first| is_it(first, &case.hidden[0])),
        // Both, in any order, before anything else.
        Kind::Double => {
            findings.len() >= 2
                && [[0, 1], [1, 0]].into_iter().any(|order| {
                    order
                        .into_iter()
                        .zip(findings)
                        .all(|(index, finding)| is_it(finding, &case.hidden[index]))
                })
        }
        Kind::Outside => findings.first().is_some_and(|first| {
            first.effect == UNEXPLAINED || is_place(&first.location, &case.hidden[0].place)
        }),
    }
}

/// Whether some name is wrong: for physics outside the catalogue, a name at another place with nothing left unexplained beside
/// it; otherwise any that was not hidden.
fn has_wrong_name(case: &Case, findings: &[Finding]) -> bool {
    if case.kind == Kind::Outside && findings.iter().any(|finding| finding.effect == UNEXPLAINED) {
        return false;
    }
    let beside = !case.hidden.is_empty() && is_right(case, findings);
    findings.iter().filter(|finding| finding.effect != UNEXPLAINED).any(|finding| match case.kind {
        Kind::Outside => !is_place(&finding.location, &case.hidden[0].place),
        _ if beside && is_small_mass(case, finding) => false,
        _ => !case.hidden.iter().any(|hidden| is_it(finding, hidden)),
    })
}

/// Benches have some inertia wherever their model has none: where what was hidden has been found, that is no wrong name.
fn is_small_mass(case: &Case, finding: &Finding) -> bool {
    let is_bare =
        |model: Model| model.nodes.iter().any(|node| node.name == finding.location && node.inertia.is_none());
    finding.effect == "missing_inertia" && case.base().is_ok_and(is_bare)
}

/// `None` where the answer does not say how far it is from the noise.
fn at_the_floor(diagnosis: &Diagnosis) -> Option<bool> {
    let channels = diagnosis.fit.channels.iter();
    let ratios: Vec<f64> =
        channels.filter_map(|(_, fit)| Some(fit.holdout_rms_after? / fit.noise_std?)).collect();
    (!ratios.is_empty()).then(|| ratios.iter().all(|ratio| *ratio <= AT_THE_FLOOR))
}

/// Parameters with an interval, and whether it holds the truth.
fn intervals(hidden: &Hidden, findings: &[Finding]) -> Vec<(String, bool)> {
    let same = |finding: &&Finding| finding.effect == hidden.effect && finding.location == hidden.place;
    let Some(finding) = findings.iter().find(same) else { return Vec::new() };
    let each = hidden.parameters.iter().filter_map(|(name, truth)| {
        let known = finding.parameters.iter().find(|parameter| parameter.name == *name)?;
        if known.ci95 == [None, None] {
            return None;
        }
        let [low, high] =
            [known.ci95[0].unwrap_or(f64::NEG_INFINITY), known.ci95[1].unwrap_or(f64::INFINITY)];
        let truth = if name == "phase" { nearest_turn(*truth, low, high) } else { *truth };
        Some((name.clone(), (low..=high).contains(&truth)))
    });
    each.collect()
}

/// The same phase, in the turn that an interval is in.
fn nearest_turn(phase: f64, low: f64, high: f64) -> f64 {
    let middle = 0.5 * (low + high);
    if middle.is_finite() { phase + TAU * ((middle - phase) / TAU).round() } else { phase }
}

#[cfg(test)]
mod tests;
