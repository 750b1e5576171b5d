//! Why an effect is no finding: the corrected model with that effect, fitted to its end whatever the search made of it.

use socam_identify::IdentifyError;

use crate::{
    context::Context,
    document::{CandidateFate, Stage, Trial, UNEXPLAINED},
    given_up,
    selection::Path,
};

/// Grid points of the effect, by the score test, whose starts are fitted.
const GRID_POINTS: usize = 2;

/// How far each candidate of the search came, with the trials of those that the options ask for.
pub(crate) fn fates(context: &Context<'_>, path: &Path) -> Result<Vec<CandidateFate>, IdentifyError> {
    let mut all = context.journal.fates();
    for (effect, location) in &context.options.why {
        let is_it = |one: &CandidateFate| one.effect == *effect && one.location == *location;
        let index = all.iter().position(is_it).unwrap_or_else(|| {
            let sentence =
                "No score test was made of it: it is part of the model, or equal to an effect that was found";
            all.push(CandidateFate::new(effect, location, (Stage::NotProposed, 1), sentence.into()));
            all.len() - 1
        });
        all[index].asked = true;
        if all[index].stage != Stage::Found && !context.stops() {
            all[index].trials = trials(context, path, (effect, location))?;
        }
    }
    all.sort_by_key(|one| std::cmp::Reverse((one.asked, one.stage)));
    Ok(all)
}

/// The trials of an effect at a place, the best gain first. Empty where every fit overflows.
fn trials(
    context: &Context<'_>,
    path: &Path,
    (effect, location): (&str, &str),
) -> Result<Vec<Trial>, IdentifyError> {
    let starts = given_up::starts(context, path, (effect, location), GRID_POINTS)?;
    let curve = match &path.unexplained {
        Some(curve) => context.refitted(&curve.fitted, &path.noise)?.map(|fitted| (curve, fitted)),
        None => None,
    };
    let corrected = curve.as_ref().map_or(&path.last, |(_, fitted)| fitted);
    let named = (0..path.terms.len()).filter(|_| curve.is_none());
    let mut all = Vec::new();
    for instead_of in std::iter::once(None).chain(named.map(Some)) {
        let base = match instead_of {
            None => Some((path.last.model.clone(), path.last.at.values.clone())),
            Some(term) => path.start_without(term),
        };
        let Some((model, values)) = base else { continue };
        let best = given_up::best_fit(context, (&model, &values), &path.noise, &starts)?;
        let Some((model, at)) = best else { continue };
        let Some(fitted) = context.validated(&model, at, &path.noise)? else { continue };
        let gained = path.gain(&fitted, corrected);
        let of_term = instead_of.map(|term: usize| {
            let candidate = &path.terms[term].candidate;
            (candidate.effect.id.to_owned(), candidate.place.clone())
        });
        let of_curve = curve.as_ref().map(|(curve, _)| (UNEXPLAINED.to_owned(), curve.place.clone()));
        let instead_of = of_term.or(of_curve);
        // A fit that its prior excludes has no score.
        if gained.log_score.is_finite() {
            all.push(Trial { instead_of, log_score: gained.log_score, std: gained.std });
        }
    }
    all.sort_by(|a, b| b.log_score.total_cmp(&a.log_score));
    Ok(all)
}
