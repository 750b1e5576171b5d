//! Candidates fitted side by side, and given up when they fall behind.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError,
    compare::{self, Measured, Yardstick},
};
use socam_model::Model;

use crate::{
    bench::{Bench, Fitted},
    candidates::Candidate,
    document::Validation,
    screen::carried,
};

/// Iterations: so many to begin with, then so often so many more, unless these gained next to nothing.
const FIRST_LEG: usize = 4;
/// Iterations to begin with for what does not begin weak.
const FAR_LEG: usize = 10;
const LEGS: usize = 4;
const LEG: usize = 5;
const NEXT_TO_NOTHING: f64 = 5.0;
/// Share of what the best gained that the others must have gained to stay in the race, after the first leg and later; or how near they
/// must be to it.
const IN_THE_RACE: [f64; 2] = [0.2, 0.5];
const NEAR: f64 = 25.0;

/// A candidate's fit on its way.
struct Runner {
    /// Among those that are tried.
    index: usize,
    model: Model,
    at: Measured,
    done: bool,
}

/// Fits what is tried, all for some iterations, then those that are still in the race.
pub(crate) fn race(
    bench: &Bench<'_>,
    before: &Fitted,
    tried: &[(Candidate, f64)],
    yardstick: &Yardstick,
) -> Result<Vec<(usize, Fitted)>, IdentifyError> {
    let begun = tried.par_iter().enumerate().map(|(index, (candidate, _))| {
        let grown = before.model.with_effect(candidate.effect.id, &candidate.place, &candidate.values);
        let Ok(grown) = grown else { return Ok(None) };
        // While an effect is weak, nothing says what its other parameters should be: they wait for its strength.
        let is_far = candidate.is_far();
        let mut begun = grown.clone();
        if let Some(used) = grown.effects.last().filter(|_| !is_far) {
            let own = used.effect.parameters.iter().zip(&used.parameters);
            let others = own.filter(|(parameter, _)| !candidate.strength.contains(&parameter.name));
            others.for_each(|(_, index)| begun.parameters[*index].fixed = true);
        }
        let values = carried((&before.model, &before.at.values), &grown);
        // From start states of its own: where physics is missing, those of the fit before make up for it.
        let leg = (compare::COARSE, if is_far { FAR_LEG } else { FIRST_LEG });
        let at = compare::descend(&bench.problem(&begun)?, yardstick, &values, None, leg)?;
        Ok(at.map(|at| Runner { index, model: grown, done: false, at }))
    });
    let begun: Result<Vec<_>, IdentifyError> = begun.collect();
    let mut runners: Vec<Runner> = begun?.into_iter().flatten().collect();
    for leg in 0..LEGS {
        let least = least(bench, before, &mut runners, yardstick)?;
        let share = IN_THE_RACE[leg.min(1)];
        let line = (before.at.total() - share * (before.at.total() - least)).max(least + NEAR);
        runners.retain(|runner| runner.at.total() < line);
        one_each(&mut runners, tried);
        let next = runners.into_par_iter().map(|runner| further(bench, runner, yardstick));
        runners = next.collect::<Result<_, IdentifyError>>()?;
    }
    let each = runners.into_par_iter().map(|Runner { index, model, at, .. }| {
        Ok(bench.held(&model, at, yardstick)?.map(|fitted| (index, fitted)))
    });
    let all: Result<Vec<_>, IdentifyError> = each.collect();
    Ok(all?.into_iter().flatten().collect())
}

/// What the leader leaves in training: the one that came furthest of those that predict held-out recordings better than `before`, for
/// what only follows the noise of some recordings must not outrun what is there; of all if none does. Sorts them.
fn least(
    bench: &Bench<'_>,
    before: &Fitted,
    runners: &mut [Runner],
    yardstick: &Yardstick,
) -> Result<f64, IdentifyError> {
    runners.sort_by(|a, b| a.at.total().total_cmp(&b.at.total()));
    let first = runners.first().map_or(f64::INFINITY, |runner| runner.at.total());
    // Where recordings are left out in turn, that would take as many fits.
    if bench.folds.kind == Validation::Holdout {
        for runner in runners.iter().take_while(|runner| runner.at.total() < before.at.total()) {
            let held = bench.held(&runner.model, runner.at.clone(), yardstick)?;
            if held.is_some_and(|held| held.held_chi2() < before.held_chi2()) {
                return Ok(runner.at.total());
            }
        }
    }
    Ok(first.min(before.at.total()))
}

/// Where an effect was begun in several ways, the one that came furthest, the first of sorted ones, goes on.
fn one_each(runners: &mut Vec<Runner>, tried: &[(Candidate, f64)]) {
    let mut known: Vec<usize> = Vec::new();
    runners.retain(|runner| {
        let is_new = known.iter().all(|other| !tried[*other].0.is_same(&tried[runner.index].0));
        known.push(runner.index);
        is_new
    });
}

fn further(bench: &Bench<'_>, runner: Runner, yardstick: &Yardstick) -> Result<Runner, IdentifyError> {
    let Runner { index, model, at, done } = runner;
    if done {
        return Ok(Runner { index, model, at, done });
    }
    let leg = (compare::COARSE, LEG);
    let next = compare::descend(&bench.problem(&model)?, yardstick, &at.values, Some((&model, &at)), leg)?;
    let next = next.unwrap_or_else(|| at.clone());
    let unit = (next.total() / next.count.iter().sum::<f64>().max(1.0)).max(1.0);
    let done = next.converged || at.total() - next.total() < NEXT_TO_NOTHING * unit;
    Ok(Runner { index, model, at: next, done })
}
