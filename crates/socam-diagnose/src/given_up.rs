//! Candidates that the race gave up, fitted to their end: before the search says that nothing with a name explains a curve, and for `why`.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError,
    comparison::{self, Evaluation, NoiseModel},
};
use socam_model::Model;

use crate::{
    candidate::Candidate,
    candidates,
    choice::{self, Choice},
    context::Context,
    extension::{carried_over, extended},
    halving::Finalist,
    nonparametric::term::Unexplained,
    selection::Path,
};

/// Largest number of iterations of such a fit: slow candidates take more than the race gives them.
const ITERATIONS: usize = 60;
/// Largest number of candidates at a curve's place that are fitted to their end, those that score best.
const MOST: usize = 3;

impl Path {
    /// The best of the candidates at a curve's place that this step gave up, each fitted to its end, if the curve does not beat it.
    pub(crate) fn best_given_up(
        &self,
        context: &Context<'_>,
        curve: &Unexplained,
    ) -> Result<Option<Choice>, IdentifyError> {
        let given_up = context.journal.given_up();
        let mut tried: Vec<(Candidate, f64)> = Vec::new();
        for one in self.tests.iter().filter(|one| one.possible && one.start.place == curve.place) {
            let is_given_up = given_up.contains(&(one.start.effect.id, one.start.place.clone()));
            let is_new = !tried.iter().any(|(known, _)| known.is_same(&one.start));
            if is_given_up && is_new && tried.len() < MOST {
                tried.push((one.start.clone(), one.p_value));
            }
        }
        let before = (&self.last.model, &*self.last.at.values);
        let mut finalists = Vec::new();
        for (index, (candidate, _)) in tried.iter().enumerate() {
            let starts = starts(context, self, (candidate.effect.id, &candidate.place), 1)?;
            let best = best_fit(context, before, &self.noise, &starts)?;
            finalists.extend(best.map(|(model, at)| Finalist { index, model, at }));
        }
        let Some(late) = choice::among(context, self, &tried, &finalists)? else { return Ok(None) };
        Ok(if curve.beats(context, self, &late)? { None } else { Some(late) })
    }
}

/// Small and usual amplitudes of an effect at a place, at those of its grid points that score best.
pub(crate) fn starts(
    context: &Context<'_>,
    path: &Path,
    (effect, location): (&str, &str),
    grid_points: usize,
) -> Result<Vec<Candidate>, IdentifyError> {
    let is_it = |one: &&Candidate| one.effect.id == effect && one.place == location;
    let (model, values) = (&path.last.model, &path.last.at.values);
    let mut own: Vec<Candidate> = path.tests.iter().map(|one| &one.start).filter(is_it).cloned().collect();
    if own.is_empty() {
        let all = candidates::all(model, &path.scales(context)?);
        own = all.iter().filter(is_it).cloned().collect();
    }
    own.truncate(grid_points);
    let begun = own.into_iter().flat_map(|one| {
        let usual = candidates::usual_starts(&one, &path.priors.rig);
        candidates::starts(one, model, values).into_iter().chain(usual)
    });
    Ok(begun.collect())
}

/// The best fit of a model with one more effect, of those from several starts. `None` where it cannot act, or every fit overflows.
pub(crate) fn best_fit(
    context: &Context<'_>,
    (model, values): (&Model, &[f64]),
    noise: &NoiseModel,
    starts: &[Candidate],
) -> Result<Option<(Model, Evaluation)>, IdentifyError> {
    let fits = starts.par_iter().map(|start| {
        let Some(more) = extended(model, start) else { return Ok(None) };
        let values = carried_over((model, values), &more);
        let round = (comparison::FINE, ITERATIONS);
        let at = comparison::descend(&context.tentative(&more)?, noise, &values, None, round)?;
        Ok(at.map(|at| (more, at)))
    });
    let fits: Result<Vec<Option<_>>, IdentifyError> = fits.collect();
    let least = |a: &(Model, Evaluation), b: &(Model, Evaluation)| a.1.total().total_cmp(&b.1.total());
    Ok(fits?.into_iter().flatten().min_by(least))
}
