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
pub(crate) fn run(
    context: &Context<'_>,
    before: &FittedModel,
    tried: &[Candidate],
    noise: &NoiseModel,
) -> Result<Vec<Finalist>, IdentifyError> {
    successive_halving(context, before, tried, noise, |candidate| begin(context, before, noise, candidate))
}

/// Fits each of `tried` from a large amplitude and the file's values of all other parameters. A fit is given up where its deviance stays
/// far above `best`, the least deviance so far by recording.
pub(crate) fn run_large(
    context: &Context<'_>,
    before: &FittedModel,
    tried: &[Candidate],
    noise: &NoiseModel,
    best: &[f64],
) -> Result<Vec<Finalist>, IdentifyError> {
    successive_halving(context, before, tried, noise, |candidate| {
        let Some(model) = extended(&before.model, candidate) else { return Ok(None) };
        // A large missing effect has displaced all base parameters.
        let values = carried_over((&before.model, &file_values(before)), &model);
        let at = descend_from_afar(context, &model, &values, noise, best)?;
        Ok(at.map(|at| (model, at)))
    })
}

/// Starts all candidates with `begin`, then continues those that keep up, round by round, until the search is ended.
fn successive_halving(
    context: &Context<'_>,
    before: &FittedModel,
    tried: &[Candidate],
    noise: &NoiseModel,
    begin: impl Fn(&Candidate) -> Result<Option<(Model, Evaluation)>, IdentifyError> + Sync,
) -> Result<Vec<Finalist>, IdentifyError> {
    let begun = tried.par_iter().enumerate().map(|(index, candidate)| {
        if context.stops() {
            return Ok(None);
        }
        let begun = begin(candidate)?;
        let iterations = first_round(candidate);
        Ok(begun.map(|(model, at)| Contender { index, model, at, iterations, done: false }))
    });
    let begun: Result<Vec<Option<Contender>>, IdentifyError> = begun.collect();
    let mut contenders: Vec<Contender> = begun?.into_iter().flatten().collect();
    note_diverged(context, &contenders, tried);
    for round in 0..ROUNDS {
        if context.stops() {
            break;
        }
        keep_up(context, &mut contenders, tried, before.deviance(), KEEPING_UP[round.min(1)]);
        let next = contenders.into_par_iter().map(|contender| continued(context, contender, noise));
        contenders = next.collect::<Result<_, IdentifyError>>()?;
    }
    Ok(contenders
        .into_iter()
        .map(|Contender { index, model, at, .. }| Finalist { index, model, at })
        .collect())
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

/// Keeps contenders whose gain is this share of the best one's or near it, sorted with the best first, one per effect and place.
fn keep_up(
    context: &Context<'_>,
    contenders: &mut Vec<Contender>,
    tried: &[Candidate],
    before: f64,
    share: f64,
) {
    contenders.sort_by(|a, b| a.at.total().total_cmp(&b.at.total()));
    let least = contenders.first().map_or(before, |contender| contender.at.total()).min(before);
    let line = (before - share * (before - least)).max(least + NEAR);
    keep_best_of_each(contenders, tried);
    contenders.retain(|contender| {
        let (iterations, deviance) = (contender.iterations, contender.at.total());
        if deviance >= line {
            let fate = Fate::RacedOut { iterations, deviance, best: least };
            context.journal.note(&tried[contender.index], fate);
        }
        deviance < line
    });
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

/// The first round of a candidate that begins at a small amplitude.
fn begin(
    context: &Context<'_>,
    before: &FittedModel,
    noise: &NoiseModel,
    candidate: &Candidate,
) -> Result<Option<(Model, Evaluation)>, IdentifyError> {
    let Some(grown) = extended(&before.model, candidate) else { return Ok(None) };
    // At a small amplitude the effect's other parameters are not determined: they stay fixed in the first round.
    let is_free = candidate.needs_restarts();
    let mut begun = grown.clone();
    if let Some(used) = grown.effects.last().filter(|_| !is_free) {
        let own = used.effect.parameters.iter().zip(&used.parameters);
        let others = own.filter(|(parameter, _)| !candidate.amplitudes.contains(&parameter.name));
        others.for_each(|(_, index)| begun.parameters[*index].fixed = true);
    }
    let values = carried_over((&before.model, &before.at.values), &grown);
    let round = (comparison::COARSE, first_round(candidate));
    let problem = context.tentative(&begun)?;
    // Start states are estimated anew, because those of the previous fit compensate for the missing physics. From these a fit may run away
    // from the data, such as that of a pendulum that turns over, and those of many short segments take more iterations than a round has:
    // then the previous ones are where it begins.
    let anew = comparison::descend(&problem, noise, &values, None, round)?;
    let at = match anew.filter(|at| at.total() < before.deviance()) {
        None => comparison::descend(&problem, noise, &values, Some((&before.model, &before.at)), round)?,
        anew => anew,
    };
    Ok(at.map(|at| (grown, at)))
}

/// The file's values of the base model's parameters outside effects, and the fitted values of effects' parameters.
fn file_values(before: &FittedModel) -> Vec<f64> {
    let mut values = before.model.values();
    for index in before.model.effects.iter().flat_map(|used| &used.parameters) {
        values[*index] = before.at.values[*index];
    }
    values
}

/// A descent from values far from the optimum: first on the recording with the largest deviance in `best`, then on all. `None` where it was
/// given up.
pub(crate) fn descend_from_afar(
    context: &Context<'_>,
    model: &Model,
    values: &[f64],
    noise: &NoiseModel,
    best: &[f64],
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

/// One further round of a contender.
fn continued(
    context: &Context<'_>,
    contender: Contender,
    noise: &NoiseModel,
) -> Result<Contender, IdentifyError> {
    let Contender { index, model, at, iterations, done } = contender;
    if done || context.stops() {
        return Ok(Contender { index, model, at, iterations, done });
    }
    let round = (comparison::COARSE, ROUND_ITERATIONS);
    let next =
        comparison::descend(&context.tentative(&model)?, noise, &at.values, Some((&model, &at)), round)?;
    let next = next.unwrap_or_else(|| at.clone());
    let unit = (next.total() / next.count.iter().sum::<f64>().max(1.0)).max(1.0);
    let done = next.converged || at.total() - next.total() < LEAST_FALL * unit;
    Ok(Contender { index, model, iterations: iterations + ROUND_ITERATIONS, at: next, done })
}
