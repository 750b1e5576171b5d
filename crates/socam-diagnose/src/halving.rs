//! Successive halving: all candidates are fitted for a few iterations, then only those whose deviance keeps up with the best (K. Jamieson
//! and A. Talwalkar, AISTATS 2016). Only the training deviance decides which candidates continue.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError, Problem,
    comparison::{self, Evaluation, NoiseModel},
};
use socam_model::Model;

use crate::{
    candidate::Candidate,
    context::{self, Context, FittedModel},
    extension::{carried_over, extended},
    journal::Fate,
    selection::DISPLACED,
};

/// Iterations of the first round.
const FIRST_ROUND: usize = 4;
/// Iterations of the first round of a candidate whose amplitude cannot be predicted from sensitivities.
const RESTART_ROUND: usize = 10;
/// Rounds of a candidate with a large start amplitude: iterations, and the largest multiple of the best deviance so far that it may have
/// after them. With several recordings, the first [`ON_ONE`] of these rounds use one recording.
const LARGE_ROUNDS: [(usize, f64); 4] = [(10, 30.0), (10, 10.0), (10, 10.0), (20, 2.0)];
const ON_ONE: usize = 2;
/// Number of further rounds, and iterations of each.
const ROUNDS: usize = 4;
const ROUND_ITERATIONS: usize = 5;
/// Iterations of the first round on all data after a race on an excerpt.
const ITERATIONS_ON_ALL: usize = 6;
/// Fall of the deviance in a round, in units of the mean square residual, below which a candidate's fit is complete.
const LEAST_FALL: f64 = 5.0;
/// Share of the best candidate's gain that another one needs to continue, after the first round and later.
const KEEPING_UP: [f64; 2] = [0.2, 0.5];
/// Deviance above the best within which a candidate continues whatever its share.
const NEAR: f64 = 25.0;

/// A candidate whose fit is in progress.
struct Contender {
    /// Index among the tried candidates.
    index: usize,
    model: Model,
    at: Evaluation,
    /// Largest number of iterations that led here.
    iterations: usize,
    /// Whether further iterations would gain next to nothing.
    done: bool,
}

/// A candidate that was fitted to the end: its index among the tried candidates, the extended model and its fit.
pub(crate) struct Finalist {
    pub(crate) index: usize,
    pub(crate) model: Model,
    pub(crate) at: Evaluation,
}

/// Fits each of `tried` added to the model of `before`, from a small amplitude. Returns the best fit of each effect and place that kept up.
/// Long recordings are raced on an excerpt first; only those that keep up there are fitted to all of them.
pub(crate) fn run(
    context: &Context<'_>,
    before: &FittedModel,
    tried: &[Candidate],
    noise: &NoiseModel,
) -> Result<Vec<Finalist>, IdentifyError> {
    let Some(brief) = context.fitted_in_brief(before, noise)? else { return Ok(Vec::new()) };
    let race = Race { context, model: &before.model, before: &brief, tried, noise, is_brief: true };
    let contenders = race.run(|candidate| race.begin(candidate))?;
    race.to_the_end(contenders, &before.at)
}

/// Fits each of `tried` from a large amplitude. A fit is given up where its deviance stays far above `best`, the least deviance so far by
/// recording.
pub(crate) fn run_large(
    context: &Context<'_>,
    before: &FittedModel,
    tried: &[Candidate],
    noise: &NoiseModel,
    best: &[f64],
) -> Result<Vec<Finalist>, IdentifyError> {
    let race = Race { context, model: &before.model, before: &before.at, tried, noise, is_brief: false };
    let contenders = race.run(|candidate| {
        let Some(model) = extended(&before.model, candidate) else { return Ok(None) };
        // A large missing effect has displaced all base parameters, so that a fit begins at the file's values.
        let begun = if noise.excess() > DISPLACED { file_values(before) } else { before.at.values.clone() };
        let values = carried_over((&before.model, &begun), &model);
        // With all parameters fitted to one recording, a contender has no less than its part of the best one's gain there.
        let line = |one: usize| keeping_up(before.at.chi2[one], best[one], KEEPING_UP[0]);
        let at = descend_from_afar(context, &model, &values, noise, (best, line))?;
        Ok(at.map(|at| (model, at)))
    })?;
    Ok(finalists(contenders))
}

/// The fits of contenders.
fn finalists(contenders: Vec<Contender>) -> Vec<Finalist> {
    contenders.into_iter().map(|Contender { index, model, at, .. }| Finalist { index, model, at }).collect()
}

/// A race of candidates, on all data or on an excerpt of them.
#[derive(Clone, Copy)]
struct Race<'r, 'c> {
    context: &'r Context<'c>,
    /// The model to which each candidate is added, and its fit to the same data.
    model: &'r Model,
    before: &'r Evaluation,
    tried: &'r [Candidate],
    noise: &'r NoiseModel,
    is_brief: bool,
}

impl Race<'_, '_> {
    /// Starts all candidates with `begin`, then continues those that keep up, round by round, until the search is ended.
    fn run(
        &self,
        begin: impl Fn(&Candidate) -> Result<Option<(Model, Evaluation)>, IdentifyError> + Sync,
    ) -> Result<Vec<Contender>, IdentifyError> {
        let begun = self.tried.par_iter().enumerate().map(|(index, candidate)| {
            if self.context.stops() {
                return Ok(None);
            }
            let begun = begin(candidate)?;
            let iterations = first_round(candidate);
            Ok(begun.map(|(model, at)| Contender { index, model, at, iterations, done: false }))
        });
        let begun: Result<Vec<Option<Contender>>, IdentifyError> = begun.collect();
        let contenders: Vec<Contender> = begun?.into_iter().flatten().collect();
        note_diverged(self.context, &contenders, self.tried);
        self.rounds(contenders)
    }

    /// Continues those contenders that keep up, round by round, until the search is ended.
    fn rounds(&self, mut contenders: Vec<Contender>) -> Result<Vec<Contender>, IdentifyError> {
        for round in 0..ROUNDS {
            if self.context.stops() {
                break;
            }
            self.keep_up(&mut contenders, KEEPING_UP[round.min(1)]);
            let next = contenders.into_par_iter().map(|contender| self.continued(contender));
            contenders = next.collect::<Result<_, IdentifyError>>()?;
        }
        Ok(contenders)
    }

    /// The fits of contenders; after a race on an excerpt, of those that keep up on all data too. `whole` is the fit to these of the model
    /// before.
    fn to_the_end(
        self,
        contenders: Vec<Contender>,
        whole: &Evaluation,
    ) -> Result<Vec<Finalist>, IdentifyError> {
        if !self.context.is_long() {
            return Ok(finalists(contenders));
        }
        let race = Race { before: whole, is_brief: false, ..self };
        let fits = contenders.into_par_iter().map(|one| race.continued_on_all(one));
        let fits: Result<Vec<Option<Contender>>, IdentifyError> = fits.collect();
        Ok(finalists(race.rounds(fits?.into_iter().flatten().collect())?))
    }

    /// The fit of a model to the data of this race.
    fn problem<'m>(&'m self, model: &'m Model) -> Result<Problem<'m>, IdentifyError> {
        if self.is_brief { self.context.brief(model) } else { self.context.tentative(model) }
    }

    /// Keeps contenders whose gain is this share of the best one's or near it, sorted with the best first, one per effect and place.
    fn keep_up(&self, contenders: &mut Vec<Contender>, share: f64) {
        contenders.sort_by(|a, b| a.at.total().total_cmp(&b.at.total()));
        let before = self.before.total();
        let least = contenders.first().map_or(before, |contender| contender.at.total()).min(before);
        let line = keeping_up(before, least, share);
        keep_best_of_each(contenders, self.tried);
        contenders.retain(|contender| {
            let (iterations, deviance) = (contender.iterations, contender.at.total());
            if deviance >= line {
                let fate = Fate::RacedOut { iterations, deviance, best: least };
                self.context.journal.note(&self.tried[contender.index], fate);
            }
            deviance < line
        });
    }

    /// The first round of a candidate that begins at a small amplitude.
    fn begin(&self, candidate: &Candidate) -> Result<Option<(Model, Evaluation)>, IdentifyError> {
        let Some(grown) = extended(self.model, candidate) else { return Ok(None) };
        // At a small amplitude the effect's other parameters are not determined: they stay fixed in the first round.
        let is_free = candidate.needs_restarts();
        let mut begun = grown.clone();
        if let Some(used) = grown.effects.last().filter(|_| !is_free) {
            let own = used.effect.parameters.iter().zip(&used.parameters);
            let others = own.filter(|(parameter, _)| !candidate.amplitudes.contains(&parameter.name));
            others.for_each(|(_, index)| begun.parameters[*index].fixed = true);
        }
        let values = carried_over((self.model, &self.before.values), &grown);
        let at = self.descended(&begun, &values, first_round(candidate))?;
        Ok(at.map(|at| (grown, at)))
    }

    /// A descent of a model with a candidate. Start states are estimated anew, because those of the previous fit compensate for the missing
    /// physics. From these a fit may run away from the data, such as that of a pendulum that turns over, and those of many short segments take
    /// more iterations than a round has: then the previous ones are where it begins.
    fn descended(
        &self,
        model: &Model,
        values: &[f64],
        iterations: usize,
    ) -> Result<Option<Evaluation>, IdentifyError> {
        let (problem, round) = (self.problem(model)?, (comparison::COARSE, iterations));
        let anew = comparison::descend(&problem, self.noise, values, None, round)?;
        match anew.filter(|at| at.total() < self.before.total()) {
            None => comparison::descend(&problem, self.noise, values, Some((self.model, self.before)), round),
            anew => Ok(anew),
        }
    }

    /// One further round of a contender.
    fn continued(&self, contender: Contender) -> Result<Contender, IdentifyError> {
        let Contender { index, model, at, iterations, done } = contender;
        if done || self.context.stops() {
            return Ok(Contender { index, model, at, iterations, done });
        }
        let round = (comparison::COARSE, ROUND_ITERATIONS);
        let problem = self.problem(&model)?;
        let next = comparison::descend(&problem, self.noise, &at.values, Some((&model, &at)), round)?;
        let next = next.unwrap_or_else(|| at.clone());
        let done = next.converged || at.total() - next.total() < least_fall(&next);
        Ok(Contender { index, model, iterations: iterations + ROUND_ITERATIONS, at: next, done })
    }

    /// A contender of a race on an excerpt, fitted to all data. `None` where its prediction overflows.
    fn continued_on_all(&self, contender: Contender) -> Result<Option<Contender>, IdentifyError> {
        if self.context.stops() {
            return Ok(None);
        }
        let Contender { index, model, at, iterations, .. } = contender;
        let at = self.descended(&model, &at.values, ITERATIONS_ON_ALL)?;
        if at.is_none() {
            self.context.journal.note(&self.tried[index], Fate::Diverged);
        }
        let iterations = iterations + ITERATIONS_ON_ALL;
        Ok(at.map(|at| Contender { index, model, iterations, done: at.converged, at }))
    }
}

/// Deviance below which a contender keeps up with the best one, `least`: with this share of the gain over the model before, or near it.
fn keeping_up(before: f64, least: f64, share: f64) -> f64 {
    (before - share * (before - least)).max(least + NEAR)
}

/// Fall of the deviance of a fit that counts as next to nothing.
pub(crate) fn least_fall(at: &Evaluation) -> f64 {
    LEAST_FALL * reduced_chi_square(at).max(1.0)
}

/// Sum of squared whitened residuals over their number.
pub(crate) fn reduced_chi_square(at: &Evaluation) -> f64 {
    at.total() / at.count.iter().sum::<f64>().max(1.0)
}

/// Largest number of iterations of a candidate's first round.
fn first_round(candidate: &Candidate) -> usize {
    if candidate.begins_large {
        LARGE_ROUNDS.iter().map(|(iterations, _)| iterations).sum()
    } else if candidate.needs_restarts() {
        RESTART_ROUND
    } else {
        FIRST_ROUND
    }
}

/// Notes the effects and places of which no fit was begun.
fn note_diverged(context: &Context<'_>, contenders: &[Contender], tried: &[Candidate]) {
    for (index, candidate) in tried.iter().enumerate().filter(|_| !context.stops()) {
        let is_first = !tried[..index].iter().any(|other| other.is_same(candidate));
        if is_first && !contenders.iter().any(|one| tried[one.index].is_same(candidate)) {
            context.journal.note(candidate, Fate::Diverged);
        }
    }
}

/// The file's values of the base model's parameters outside effects, and the fitted values of effects' parameters.
fn file_values(before: &FittedModel) -> Vec<f64> {
    let mut values = before.model.values();
    for index in before.model.effects.iter().flat_map(|used| &used.parameters) {
        values[*index] = before.at.values[*index];
    }
    values
}

/// A descent from values far from the optimum: first on the recording with the largest deviance in `best`, then on all, if it does not end on
/// the first above what `line` says for it. `None` where it was given up.
pub(crate) fn descend_from_afar(
    context: &Context<'_>,
    model: &Model,
    values: &[f64],
    noise: &NoiseModel,
    (best, line): (&[f64], impl Fn(usize) -> f64),
) -> Result<Option<Evaluation>, IdentifyError> {
    let all = context.tentative(model)?;
    let total = best.iter().sum();
    if best.len() == 1 {
        return context::descend_in_rounds(&all, noise, values, total, &LARGE_ROUNDS);
    }
    let most = (0..best.len()).max_by(|a, b| best[*a].total_cmp(&best[*b])).unwrap_or(0);
    let one = Problem::new(model, std::slice::from_ref(&context.training[most]), context.tentative_fit())?;
    let (on_one, on_all) = LARGE_ROUNDS.split_at(ON_ONE);
    let near = context::descend_in_rounds(&one, noise, values, best[most], on_one)?;
    let near = near.filter(|near| !near.converged || near.total() < line(most));
    near.map_or(Ok(None), |near| context::descend_in_rounds(&all, noise, &near.values, total, on_all))
}

/// Keeps the first of the sorted contenders of each effect and place.
fn keep_best_of_each(contenders: &mut Vec<Contender>, tried: &[Candidate]) {
    let mut known: Vec<usize> = Vec::new();
    contenders.retain(|contender| {
        let is_new = known.iter().all(|other| !tried[*other].is_same(&tried[contender.index]));
        known.push(contender.index);
        is_new
    });
}
