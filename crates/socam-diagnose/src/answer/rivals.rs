//! Competing models of a finding, and the experiment that distinguishes them.

use crate::{
    candidate::Candidate,
    document::{Finding, Rival, SuggestedExperiment},
    experiment,
    selection::{Path, Term},
};

/// Least weight of a competing model that is listed.
const LEAST_WEIGHT: f64 = 1e-2;
/// Least weight of a competing model for which another experiment is suggested.
const OPEN: f64 = 0.05;

/// Competing models with their weights, the largest first. Observationally equivalent effects share the finding's own weight. Effects that
/// are terms of the path are not competitors.
pub(super) fn rivals(path: &Path, term: &Term, equivalent: &[Candidate]) -> Vec<Rival> {
    let is_equivalent = |rival: &Candidate| equivalent.iter().any(|other| other.is_same(rival));
    let others: Vec<&(Candidate, f64)> =
        term.rivals.iter().filter(|(rival, _)| !is_equivalent(rival) && !path.has(rival)).collect();
    let own = 1.0 - others.iter().map(|(_, weight)| weight).sum::<f64>();
    let share = own / (1 + equivalent.len()) as f64;
    let all = equivalent
        .iter()
        .map(|other| (other, share))
        .chain(others.iter().map(|(rival, weight)| (rival, *weight)));
    let named = all.map(|(candidate, weight)| Rival {
        effect: candidate.effect.id.into(),
        location: candidate.place.clone(),
        weight,
    });
    let mut named: Vec<Rival> = named.filter(|rival| rival.weight > LEAST_WEIGHT).collect();
    named.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    named
}

/// The next experiment: one that distinguishes the first open finding from its competitors, or else one that shows an unnamed curve better.
pub(super) fn suggestion(findings: &[Finding]) -> Option<SuggestedExperiment> {
    let is_open = |finding: &&Finding| finding.rivals.first().is_some_and(|rival| rival.weight > OPEN);
    match findings.iter().find(is_open) {
        Some(open) => experiment::suggestion(open),
        None => findings.iter().find_map(experiment::shape),
    }
}
