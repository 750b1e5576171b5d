//! Nested laws: those that contain a term's law as a special case, and those that the term's law contains.

use socam_model::{
    Model,
    effects::{self, REFINED, Values},
};

use crate::{candidate::Candidate, selection::Path};

/// Refined laws that contain a candidate's law, the simplest first, each with several start values of its additional parameters.
pub(crate) fn refined_laws(candidate: &Candidate, model: &Model) -> Vec<Vec<Candidate>> {
    let laws = REFINED.iter().map(|effect| {
        let values = effect.given().map(|own| (own.name, candidate.value(own.name))).collect();
        let refined =
            Candidate { speed: candidate.speed, ..Candidate::new(effect, &candidate.place, values) };
        refined.in_place_of(candidate, &candidate.values, model)
    });
    laws.filter(|starts| !starts.is_empty()).collect()
}

/// Starts of laws among `all` candidates that contain a term's law, from the term's fitted values. Refined laws are included if their
/// additional parameters are known.
pub(crate) fn richer_laws(path: &Path, term: usize, all: &[Candidate]) -> Vec<Candidate> {
    let own = &path.terms[term].candidate;
    let fitted = path.fitted_parameters(term);
    let mut starts: Vec<Candidate> =
        all.iter().flat_map(|start| start.in_place_of(own, &fitted, &path.last.model)).collect();
    let richer = starts.clone();
    let refined = richer.iter().flat_map(|start| refined_laws(start, &path.base.model)).flatten();
    for start in refined.filter(|start| richer.iter().any(|before| before.is_same(start))) {
        let known = fitted.iter().filter(|(name, _)| !richer[0].values.iter().any(|(own, _)| own == name));
        let start = known.fold(start, |start, (name, value)| start.with(name, *value));
        if starts.iter().all(|other| other.values != start.values) {
            starts.push(start);
        }
    }
    starts
}

/// Laws with fewer parameters that a term's law contains as special cases, at its fitted values, the simplest first.
pub(crate) fn simpler_laws(path: &Path, term: usize) -> Vec<Candidate> {
    let own = &path.terms[term].candidate;
    let fitted = path.fitted_parameters(term);
    let is_contained =
        |id: &str| id == own.effect.id || own.effect.replaces.iter().any(|simpler| simpler.law == id);
    let laws = effects::CATALOGUE.iter().chain(REFINED).filter(|effect| is_contained(effect.id));
    let each = laws.filter(|effect| effect.given().count() < own.values.len()).filter_map(|effect| {
        let value = |name: &str| fitted.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
        let values: Option<Values> =
            effect.given().map(|given| Some((given.name, value(given.name)?))).collect();
        Some(Candidate { speed: own.speed, ..Candidate::new(effect, &own.place, values?) })
    });
    let mut simpler: Vec<Candidate> = each.collect();
    simpler.sort_by_key(|law| law.values.len());
    simpler
}
