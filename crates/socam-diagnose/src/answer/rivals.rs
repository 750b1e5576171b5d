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

/// Competing models with their weights, the largest first, and the laws that contain the finding's own, with their parts of its weight.
/// Observationally equivalent effects share the finding's own weight. Effects that are terms of the path are not competitors.
pub(super) fn rivals(path: &Path, term: &Term, equivalent: &[Candidate]) -> (Vec<Rival>, Vec<Rival>) {
    let is_equivalent = |rival: &Candidate| equivalent.iter().any(|other| other.is_same(rival));
    let others: Vec<&(Candidate, f64)> =
        term.rivals.iter().filter(|(rival, _)| !is_equivalent(rival) && !path.has(rival)).collect();
    let own = 1.0 - others.iter().map(|(_, weight)| weight).sum::<f64>();
    let share = own / (1 + equivalent.len()) as f64;
    let all = equivalent
        .iter()
        .map(|other| (other, share))
        .chain(others.iter().map(|(rival, weight)| (rival, *weight)));
    let richer = term.richer.iter().filter(|(law, _)| !path.has(law)).map(|(law, part)| (law, part * share));
    (listed(all), listed(richer))
}

/// Candidates whose weight matters, the largest first.
fn listed<'a>(candidates: impl Iterator<Item = (&'a Candidate, f64)>) -> Vec<Rival> {
    let all = candidates.map(|(candidate, weight)| Rival {
        effect: candidate.effect.id.into(),
        location: candidate.place.clone(),
        weight,
    });
    let mut all: Vec<Rival> = all.filter(|rival| rival.weight > LEAST_WEIGHT).collect();
    all.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    all
}

/// The next experiment: one that distinguishes the first open finding from its competitors, or else one that shows an unnamed curve better.
pub(super) fn suggestion(findings: &[Finding]) -> Option<SuggestedExperiment> {
    let is_open = |finding: &&Finding| finding.rivals.first().is_some_and(|rival| rival.weight > OPEN);
    match findings.iter().find(is_open) {
        Some(open) => experiment::suggestion(open),
        None => findings.iter().find_map(experiment::shape),
    }
}
