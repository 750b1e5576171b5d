//! Model selection among the fitted candidates: the simplest within one standard error of the best.

use rayon::prelude::*;
use socam_identify::{IdentifyError, comparison::NoiseModel};

use crate::{
    candidate::Candidate,
    context::{Context, FittedModel},
    criterion::{self, Scored},
    drag,
    halving::{self, Finalist},
    journal::{self, Fate},
    scales::Scales,
    selection::{DISPLACED, EXCESS, Path, Term},
};

/// Share of the last model's deviance that the best small start must leave for large starts to be tried.
const FAR: f64 = 0.1;

/// The chosen term, with the fits that it was chosen by.
pub(crate) struct Choice {
    pub(crate) term: Term,
    /// The model with the term, at its fit.
    pub(crate) fitted: FittedModel,
    /// The model without the term, at its fit under the same noise model.
    pub(crate) before: FittedModel,
    /// Deviance reduction in training, under the previous noise model.
    pub(crate) deviance_reduction: f64,
    /// Sensor noise and discrepancy, estimated from the residuals of the candidate with the least deviance.
    pub(crate) noise: NoiseModel,
}

/// Fits the candidates `tried` (with their p-values) and chooses one. With `scales`, faults of single sensors and large starts are tried
/// too if the residuals stay large. `None` where no candidate predicts better than the last model by more than a standard error, or the search
/// was ended.
pub(crate) fn best(
    context: &Context<'_>,
    path: &Path,
    tried: &[(Candidate, f64)],
    scales: Option<&Scales>,
) -> Result<Option<Choice>, IdentifyError> {
    let (mut large, mut tried): (Vec<_>, Vec<_>) =
        tried.iter().cloned().partition(|(candidate, _)| candidate.begins_large);
    let mut finalists = halving::run(context, &path.last, &starts(&tried), &path.noise)?;
    if scales.is_some() {
        add_neighbours(context, path, &mut tried, &mut finalists)?;
    }
    if context.stops() {
        return Ok(None);
    }
    // Large starts cost the most iterations: they are tried only where the residuals of every small start stay far above the noise.
    let leader = leader(&finalists).map(|one| &one.at);
    let leader = leader.filter(|leader| leader.total() < path.last.deviance()).unwrap_or(&path.last.at);
    let share = leader.total() / path.last.deviance();
    let left = share * path.noise.excess();
    if scales.is_some() && !(tried.is_empty() && large.is_empty()) && left > DISPLACED && share > FAR {
        large.extend(path.far_starts());
    }
    if !large.is_empty() && (finalists.is_empty() || left > EXCESS) {
        let found = halving::run_large(context, &path.last, &starts(&large), &path.noise, &leader.chi2)?;
        finalists.extend(found.into_iter().map(|one| Finalist { index: tried.len() + one.index, ..one }));
        tried.extend(large);
    }
    if let Some(scales) = scales {
        let left = finalists
            .iter()
            .map(|one| halving::reduced_chi_square(&one.at))
            .fold(path.noise.excess(), f64::min);
        for (one, finalist) in path.without_each_sensor(context, scales, left)? {
            finalists.push(Finalist { index: tried.len(), ..finalist });
            tried.push(one);
        }
    }
    among(context, path, &tried, &finalists)
}

/// Fits the significant candidates beside the best finalist that were not on the shortlist: a score at a null amplitude orders laws at one
/// place, and places of one law, by chance where the base model imitates them.
fn add_neighbours(
    context: &Context<'_>,
    path: &Path,
    tried: &mut Vec<(Candidate, f64)>,
    finalists: &mut Vec<Finalist>,
) -> Result<(), IdentifyError> {
    let Some(leader) = leader(finalists) else { return Ok(()) };
    let neighbours = path.neighbours(&tried[leader.index].0, tried, context.options.false_alarm_rate);
    let found = halving::run(context, &path.last, &starts(&neighbours), &path.noise)?;
    finalists.extend(found.into_iter().map(|one| Finalist { index: tried.len() + one.index, ..one }));
    tried.extend(neighbours);
    Ok(())
}

/// The finalist with the least deviance.
fn leader(finalists: &[Finalist]) -> Option<&Finalist> {
    finalists.iter().min_by(|a, b| a.at.total().total_cmp(&b.at.total()))
}

/// Chooses among candidates that were fitted under the path's noise model. `tried` holds the candidates, with their p-values. `None` where
/// the search was ended: some fits are then far from their end, and the comparison of such fits would choose by chance.
pub(crate) fn among(
    context: &Context<'_>,
    path: &Path,
    tried: &[(Candidate, f64)],
    finalists: &[Finalist],
) -> Result<Option<Choice>, IdentifyError> {
    let Some(leader) = leader(finalists).filter(|_| !context.stops()) else { return Ok(None) };
    let noise = context.noise_at(&leader.model, &leader.at, path.noise.levels())?;
    let noise = noise.unwrap_or_else(|| path.noise.clone());
    let Some(before) = context.compared(&path.last.model, &path.last.at, &noise)? else { return Ok(None) };
    let refitted = finalists
        .par_iter()
        .map(|one| Ok(context.compared(&one.model, &one.at, &noise)?.map(|fitted| (one.index, fitted))));
    let refitted: Result<Vec<Option<(usize, FittedModel)>>, IdentifyError> = refitted.collect();
    let refitted = refitted?;
    if context.stops() {
        return Ok(None);
    }
    for (one, _) in finalists.iter().zip(&refitted).filter(|(_, fitted)| fitted.is_none()) {
        context.journal.note(&tried[one.index].0, Fate::Diverged);
    }
    let fits = refitted.into_iter().flatten();
    // A fit outside the support of a prior is not a candidate.
    let (fits, shut_out): (Vec<_>, Vec<_>) =
        fits.partition(|(_, fitted)| path.priors.log_prior(fitted).is_finite());
    shut_out.iter().for_each(|(index, _)| context.journal.note(&tried[*index].0, Fate::ShutOut));
    let Some(chosen) = simplest(path, &before, &fits) else { return Ok(None) };
    let (index, fitted) = &fits[chosen];
    let gained = path.gain(fitted, &before);
    let best = &tried[*index].0;
    for (other, at) in fits.iter().filter(|(other, _)| !tried[*other].0.is_same(best)) {
        let less = path.gain(fitted, at);
        context.journal.note(&tried[*other].0, Fate::Worse { than: journal::named(best), less });
    }
    if !Path::is_better(&noise, gained, (fitted, &before)) {
        context.journal.note(best, Fate::NoGain(gained));
        return Ok(None);
    }
    let (candidate, p_value) = tried[*index].clone();
    let (rivals, richer) = rivals((context, path), tried, &fits, chosen, gained.log_score);
    let finalist = finalists.iter().find(|one| one.index == *index);
    let deviance_reduction = finalist.map_or(0.0, |one| path.last.deviance() - one.at.total());
    let excess_at_upgrade = f64::INFINITY;
    // Laws there that predict as well.
    let drag = |(other, at): &(usize, FittedModel)| {
        let (law, less) = (&tried[*other].0, path.gain(fitted, at));
        let is_as_good = law.place == candidate.place && less.log_score <= less.std;
        drag::of_fit(path, at, law).filter(|_| is_as_good)
    };
    let drags = fits.iter().filter_map(drag).collect();
    let term =
        Term { candidate, p_value, rivals, richer, drags, gain: gained, without: None, excess_at_upgrade };
    Ok(Some(Choice { term, fitted: fitted.clone(), before, deviance_reduction, noise }))
}

/// The candidates without their p-values.
fn starts(tried: &[(Candidate, f64)]) -> Vec<Candidate> {
    tried.iter().map(|(candidate, _)| candidate.clone()).collect()
}

/// Index of the simplest fit whose tempered log score plus log prior is within one standard error, or one nat, of the highest. Tempering
/// divides log scores so that the difference a law's discrepancy can make counts as one nat.
fn simplest(path: &Path, before: &FittedModel, fits: &[(usize, FittedModel)]) -> Option<usize> {
    let prior = |index: usize| path.priors.log_prior(&fits[index].1);
    let score = |index: usize| fits[index].1.validation.log_score();
    let highest = (0..fits.len()).max_by(|a, b| score(*a).total_cmp(&score(*b)))?;
    let temper = criterion::temper(path.gain(&fits[highest].1, before).log_score);
    let likelihood = |index: usize| score(index) / temper + prior(index);
    let best = (0..fits.len()).max_by(|a, b| likelihood(*a).total_cmp(&likelihood(*b)))?;
    let is_near = |other: &usize| {
        let std = criterion::difference(&fits[best].1.validation, &fits[*other].1.validation).std;
        likelihood(best) - likelihood(*other) <= (std / temper).max(1.0)
    };
    let free =
        |index: usize| fits[index].1.model.parameters.iter().filter(|parameter| !parameter.fixed).count();
    let order =
        |a: &usize, b: &usize| free(*a).cmp(&free(*b)).then(likelihood(*b).total_cmp(&likelihood(*a)));
    (0..fits.len()).filter(is_near).min_by(order)
}

/// Candidates with their weights, or with their shares of a weight.
type Weighted = Vec<(Candidate, f64)>;

/// Weights of all fitted candidates except the chosen effect, the largest first; and of the laws that contain the chosen one and gain nothing
/// over it, which are no competitors, their shares of its own weight.
fn rivals(
    (context, path): (&Context<'_>, &Path),
    tried: &[(Candidate, f64)],
    fits: &[(usize, FittedModel)],
    chosen: usize,
    gained: f64,
) -> (Weighted, Weighted) {
    let scored: Vec<Scored<'_>> = fits.iter().map(|(_, fitted)| path.scored(fitted)).collect();
    let weights = criterion::weights(&scored, gained, context.options.seed);
    let own = &tried[fits[chosen].0].0;
    let is_redundant = |index: usize, fitted: &FittedModel| {
        let more = path.gain(fitted, &fits[chosen].1);
        tried[index].0.contains(own) && more.log_score <= more.std
    };
    let (mut rivals, mut richer) = (Weighted::new(), Weighted::new());
    let others = fits.iter().zip(weights).filter(|((index, _), _)| !tried[*index].0.is_same(own));
    for ((index, fitted), weight) in others {
        let candidate = &tried[*index].0;
        let list = if is_redundant(*index, fitted) { &mut richer } else { &mut rivals };
        match list.iter_mut().find(|(known, _)| known.is_same(candidate)) {
            Some((_, known)) => *known += weight,
            None => list.push((candidate.clone(), weight)),
        }
    }
    rivals.sort_by(|a, b| b.1.total_cmp(&a.1));
    let own = 1.0 - rivals.iter().map(|(_, weight)| weight).sum::<f64>();
    richer.iter_mut().for_each(|(_, weight)| *weight /= own.max(f64::MIN_POSITIVE));
    (rivals, richer)
}
