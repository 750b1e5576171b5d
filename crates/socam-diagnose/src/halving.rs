//! Candidates fitted side by side by successive halving: all for a few iterations, then those that keep up (K. Jamieson and A. Talwalkar,
//! AISTATS 2016). Only the training deviance decides who goes on.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError, Problem,
    comparison::{self, Evaluation, NoiseModel},
};
use socam_model::Model;

use crate::{
    candidates::{self, Candidate},
    context::{self, Context, FittedModel},
    score_test::carried,
};

/// Iterations: so many to begin with, then so often so many more, unless these gained next to nothing.
const FIRST_ROUND: usize = 4;
/// Iterations to begin with for what does not begin weak.
const FAR_ROUND: usize = 10;
/// Legs for what begins large: iterations, and how many times what the best so far leaves it may leave after them to go on. Of several
/// recordings so many rounds are on one.
const LARGE_ROUNDS: [(usize, f64); 4] = [(10, 30.0), (10, 10.0), (10, 10.0), (20, 2.0)];
const ON_ONE: usize = 2;
const ROUNDS: usize = 4;
const ROUND_ITERATIONS: usize = 5;
const NEXT_TO_NOTHING: f64 = 5.0;
/// Share of what the best gained that the others must have gained to go on, after the first round and later; or how near they must be to it.
const KEEPING_UP: [f64; 2] = [0.2, 0.5];
const NEAR: f64 = 25.0;

/// A candidate's fit on its way.
struct Contender {
    /// Among those that are tried.
    index: usize,
    model: Model,
    at: Evaluation,
    done: bool,
}

/// A candidate, by its number among those tried, with the model that has it and its fit.
pub(crate) struct Finalist {
    pub(crate) index: usize,
    pub(crate) model: Model,
    pub(crate) at: Evaluation,
}

/// Fits `tried`, which begin weak, in addition to the model of `before`, the best last fit of each effect and place.
pub(crate) fn run(
    context: &Context<'_>,
    before: &FittedModel,
    tried: &[Candidate],
    noise: &NoiseModel,
) -> Result<Vec<Finalist>, IdentifyError> {
    race(context, before, tried, noise, |candidate| begin(context, before, noise, candidate))
}

/// The same of those that begin large: from the file's values, given up where they stay far from `best`, what is left so far of each recording.
pub(crate) fn run_large(
    context: &Context<'_>,
    before: &FittedModel,
    tried: &[Candidate],
    noise: &NoiseModel,
    best: &[f64],
) -> Result<Vec<Finalist>, IdentifyError> {
    race(context, before, tried, noise, |candidate| {
        let Some(model) = candidates::added(&before.model, candidate) else { return Ok(None) };
        // A large effect that is missing has displaced all others: with it they begin at the file's values.
        let values = carried((&before.model, &file_values(before)), &model);
        let at = from_afar(context, &model, &values, noise, best)?;
        Ok(at.map(|at| (model, at)))
    })
}

/// Begins all, and goes on with those that keep up.
fn race(
    context: &Context<'_>,
    before: &FittedModel,
    tried: &[Candidate],
    noise: &NoiseModel,
    begin: impl Fn(&Candidate) -> Result<Option<(Model, Evaluation)>, IdentifyError> + Sync,
) -> Result<Vec<Finalist>, IdentifyError> {
    let begun = tried.par_iter().enumerate().map(|(index, candidate)| {
        let begun = begin(candidate)?;
        Ok(begun.map(|(model, at)| Contender { index, model, at, done: false }))
    });
    let begun: Result<Vec<Option<Contender>>, IdentifyError> = begun.collect();
    let mut contenders: Vec<Contender> = begun?.into_iter().flatten().collect();
    for round in 0..ROUNDS {
        keep_up(&mut contenders, tried, before.deviance(), KEEPING_UP[round.min(1)]);
        let next = contenders.into_par_iter().map(|contender| further(context, contender, noise));
        contenders = next.collect::<Result<_, IdentifyError>>()?;
    }
    Ok(contenders
        .into_iter()
        .map(|Contender { index, model, at, .. }| Finalist { index, model, at })
        .collect())
}

/// Those that gained a share of what the best gained, or came near it, the best first, each effect and place once.
fn keep_up(contenders: &mut Vec<Contender>, tried: &[Candidate], before: f64, share: f64) {
    contenders.sort_by(|a, b| a.at.total().total_cmp(&b.at.total()));
    let least = contenders.first().map_or(before, |contender| contender.at.total()).min(before);
    let line = (before - share * (before - least)).max(least + NEAR);
    contenders.retain(|contender| contender.at.total() < line);
    one_each(contenders, tried);
}

fn begin(
    context: &Context<'_>,
    before: &FittedModel,
    noise: &NoiseModel,
    candidate: &Candidate,
) -> Result<Option<(Model, Evaluation)>, IdentifyError> {
    let Some(grown) = candidates::added(&before.model, candidate) else { return Ok(None) };
    // While an effect is weak, nothing says what its other parameters should be: they wait for its amplitude.
    let is_far = candidate.is_far();
    let mut begun = grown.clone();
    if let Some(used) = grown.effects.last().filter(|_| !is_far) {
        let own = used.effect.parameters.iter().zip(&used.parameters);
        let others = own.filter(|(parameter, _)| !candidate.strength.contains(&parameter.name));
        others.for_each(|(_, index)| begun.parameters[*index].fixed = true);
    }
    let values = carried((&before.model, &before.at.values), &grown);
    // From start states of its own: where physics is missing, those of the fit before make up for it.
    let iterations = if is_far { FAR_ROUND } else { FIRST_ROUND };
    let round = (comparison::COARSE, iterations);
    let at = comparison::descend(&context.problem(&begun)?, noise, &values, None, round)?;
    Ok(at.map(|at| (grown, at)))
}

/// The file's values of all but what was added.
fn file_values(before: &FittedModel) -> Vec<f64> {
    let mut values = before.model.values();
    for index in before.model.effects.iter().flat_map(|used| &used.parameters) {
        values[*index] = before.at.values[*index];
    }
    values
}

/// A long way down from far values, given up where it leads nowhere: first to the recording of which most is left, then to all.
pub(crate) fn from_afar(
    context: &Context<'_>,
    model: &Model,
    values: &[f64],
    noise: &NoiseModel,
    best: &[f64],
) -> Result<Option<Evaluation>, IdentifyError> {
    let all = context.problem(model)?;
    let total = best.iter().sum();
    if best.len() == 1 {
        return context::down(&all, noise, values, total, &LARGE_ROUNDS);
    }
    let most = (0..best.len()).max_by(|a, b| best[*a].total_cmp(&best[*b])).unwrap_or(0);
    let one = Problem::new(model, std::slice::from_ref(&context.training[most]), context.fit.clone())?;
    let (on_one, on_all) = LARGE_ROUNDS.split_at(ON_ONE);
    let near = context::down(&one, noise, values, best[most], on_one)?;
    near.map_or(Ok(None), |near| context::down(&all, noise, &near.values, total, on_all))
}

/// Where an effect was begun in several ways, the one that came furthest, the first of sorted ones, goes on.
fn one_each(contenders: &mut Vec<Contender>, tried: &[Candidate]) {
    let mut known: Vec<usize> = Vec::new();
    contenders.retain(|contender| {
        let is_new = known.iter().all(|other| !tried[*other].is_same(&tried[contender.index]));
        known.push(contender.index);
        is_new
    });
}

fn further(
    context: &Context<'_>,
    contender: Contender,
    noise: &NoiseModel,
) -> Result<Contender, IdentifyError> {
    let Contender { index, model, at, done } = contender;
    if done {
        return Ok(Contender { index, model, at, done });
    }
    let round = (comparison::COARSE, ROUND_ITERATIONS);
    let next = comparison::descend(&context.problem(&model)?, noise, &at.values, Some((&model, &at)), round)?;
    let next = next.unwrap_or_else(|| at.clone());
    let unit = (next.total() / next.count.iter().sum::<f64>().max(1.0)).max(1.0);
    let done = next.converged || at.total() - next.total() < NEXT_TO_NOTHING * unit;
    Ok(Contender { index, model, at: next, done })
}
