//! What is chosen of all that was tried: the simplest of what predicts best, if it is proven.

use socam_identify::{IdentifyError, compare::Yardstick, influence};

use super::{Course, LEAST_GAIN, LEAST_SHARE, Proof, Step};
use crate::{
    bench::{Bench, Fitted},
    candidates::Candidate,
    document::Validation,
    race,
    scales::Scales,
    validation::Folds,
};

/// Least fall of the sum of squares on held-out recordings that counts.
const LEAST_HELD_GAIN: f64 = 10.0;
/// Differences of sums of squares between rivals count as if they were so many times smaller; or, if that is more, in units of so
/// large a share of what was gained, or of what is missed still.
const DOUBT: f64 = 4.0;
const DOUBT_SHARE: f64 = 2e-3;
const DOUBT_LEFT: f64 = 1e-2;
/// A simpler effect is preferred if it predicts held-out recordings worse by no more than this, or by no more than this share of what
/// the better one gains: real friction never quite obeys the law that is fitted, and a law with more parameters bends nearer.
const PREFERENCE: f64 = 8.0;
const PREFERENCE_SHARE: f64 = 0.05;
/// What is lost on held-out recordings, as a share of what is gained in training, below which these do not show an effect at all.
const SILENT: f64 = 1e-3;
/// From what factor on a parameter of the bench is taken to have become another, as its logarithm.
const TURNED: f64 = 1.0;

/// What was tried, with its chance, and its fit.
pub(super) type Tried = ((Candidate, f64), Fitted);

/// What was chosen.
pub(super) struct Named {
    /// The simplest of those that predict held-out recordings about best.
    pub(super) chosen: (Step, Fitted),
    /// The one that predicts them best, if it is another one at the same place.
    pub(super) nearest: Option<(Step, Fitted)>,
}

/// Fits all that are tried, with `scales` also what may be wrong with single sensors where much is left; what is chosen of them, if that
/// is worth it.
pub(super) fn best(
    bench: &Bench<'_>,
    course: &Course,
    tried: &mut Vec<(Candidate, f64)>,
    scales: Option<&Scales>,
) -> Result<Option<Named>, IdentifyError> {
    let before = &course.last;
    let mut fits = race::race(bench, before, tried, &course.yardstick)?;
    if let Some(scales) = scales {
        let left = fits.iter().map(|(_, fit)| fit.training_scale()).fold(f64::INFINITY, f64::min);
        for (one, fitted) in course.blindly(bench, scales, left)? {
            fits.push((tried.len(), fitted));
            tried.push(one);
        }
    }
    fits.sort_by(|a, b| a.1.held_chi2().total_cmp(&b.1.held_chi2()));
    let Some((_, first)) = fits.first() else { return Ok(None) };
    let (least, scale) = (first.held_chi2(), first.scale());
    let size = |index: usize| tried[index].0.values.len();
    let reach = (PREFERENCE * scale).max(PREFERENCE_SHARE * (before.held_chi2() - least));
    let near: Vec<&(usize, Fitted)> =
        fits.iter().filter(|(_, fit)| fit.held_chi2() <= least + reach).collect();
    // Of two as simple the one that says more of all recordings; left out in turn, all were held out.
    let all = |fit: &Fitted| match bench.folds.kind {
        Validation::Holdout => fit.at.total() + fit.held_chi2(),
        _ => fit.held_chi2(),
    };
    let order = |a: &(usize, Fitted), b: &(usize, Fitted)| {
        size(a.0).cmp(&size(b.0)).then(all(&a.1).total_cmp(&all(&b.1)))
    };
    let Some(simplest) = near.iter().min_by(|a, b| order(a, b)) else { return Ok(None) };
    let (index, fitted) = straightest(before, simplest, &near, PREFERENCE * first.held_scale()).clone();
    let Some(proof) = proof(bench, &course.yardstick, before, &fitted)? else { return Ok(None) };
    let is_there = |best: usize| best != index && tried[best].0.place == tried[index].0.place;
    let nearest = fits.first().filter(|(best, _)| is_there(*best)).cloned();
    let named = |(index, fitted): (usize, Fitted)| {
        let step = step(before, tried, &fits, index, &fitted);
        (Step { proof, ..step }, fitted)
    };
    Ok(Some(Named { chosen: named((index, fitted)), nearest: nearest.map(named) }))
}

/// What stands out against white noise only, if it does against noise as it is in the effect's own direction: that may be as quiet.
pub(super) fn against_noise(
    bench: &Bench<'_>,
    yardstick: &Yardstick,
    mut named: Named,
    threshold: f64,
) -> Result<Option<Named>, IdentifyError> {
    let (step, Fitted { model, at, .. }) = &mut named.chosen;
    let Candidate { effect, strength, .. } = &step.candidate;
    let nothing = step.candidate.nothing();
    let spread = influence::spread(&bench.problem(model)?, yardstick, model, at)?;
    let Some(spread) = spread.filter(|_| nothing.is_finite()) else { return Ok(None) };
    let used = model.effects.last().map_or(&[][..], |used| &used.parameters);
    let own = effect.parameters.iter().zip(used).filter(|(own, _)| strength.contains(&own.name));
    let chosen = if step.candidate.is_wave() { 2 } else { strength.len() };
    let chance = own.map(|(_, index)| spread[*index].chance(at.values[*index] - nothing, chosen));
    step.p_value = chance.fold(1.0, f64::min);
    Ok((step.p_value < threshold).then_some(named))
}

/// On what an effect that was added between two fits holds, if it is one.
pub(super) fn proof(
    bench: &Bench<'_>,
    yardstick: &Yardstick,
    before: &Fitted,
    after: &Fitted,
) -> Result<Option<Proof>, IdentifyError> {
    if is_worth_it(before, after) {
        return Ok(Some(Proof::HeldOut));
    }
    let gain = before.at.total() - after.at.total();
    let is_silent = (before.held_chi2() - after.held_chi2()).abs() < SILENT * gain;
    if !is_silent || bench.folds.kind != Validation::Holdout || gain < 0.01 * LEAST_SHARE * before.misfit() {
        return Ok(None);
    }
    let folds = Folds::in_turn(bench.training);
    let bench = Bench { folds: &folds, fit: bench.fit.clone(), ..*bench };
    let in_turn = |fitted: &Fitted| bench.held(&fitted.model, fitted.at.clone(), yardstick);
    Ok(in_turn(before)?
        .zip(in_turn(after)?)
        .filter(|(before, after)| is_worth_it(before, after))
        .map(|(before, after)| Proof::InTurn(before.held_gain_percent(&after))))
}

/// Whether what was added does something: in training, on recordings that were not fitted, and beside what is missed there.
fn is_worth_it(before: &Fitted, after: &Fitted) -> bool {
    let scale = after.scale();
    before.held_chi2() - after.held_chi2() >= LEAST_HELD_GAIN * scale
        && before.at.total() - after.at.total() >= LEAST_GAIN * scale
        && before.held_gain_percent(after) >= LEAST_SHARE
}

/// Of laws that predict about as well, one that leaves the bench as it was: of two springs in a row either may be taken for the other,
/// and with it what is wrong there.
fn straightest<'f>(
    before: &Fitted,
    chosen: &'f (usize, Fitted),
    near: &[&'f (usize, Fitted)],
    reach: f64,
) -> &'f (usize, Fitted) {
    let own = bent(before, &chosen.1);
    let as_good = |other: &&&(usize, Fitted)| other.1.held_chi2() <= chosen.1.held_chi2() + reach;
    let straighter = near.iter().filter(as_good).map(|other| (bent(before, &other.1), *other));
    let least = straighter.min_by(|a, b| a.0.total_cmp(&b.0));
    match least {
        Some((bent, other)) if own > TURNED && bent < 0.5 * own => other,
        _ => chosen,
    }
}

/// By what factor a parameter of the bench itself moved at most, as its logarithm.
fn bent(before: &Fitted, after: &Fitted) -> f64 {
    let parameters = before.model.parameters.iter().zip(&before.at.values);
    let moved = parameters.filter(|(parameter, value)| !parameter.fixed && **value > 0.0).map(
        |(parameter, value)| {
            let now = after.model.parameter(&parameter.name).map_or(*value, |index| after.at.values[index]);
            (now.max(f64::MIN_POSITIVE) / value).ln().abs()
        },
    );
    moved.fold(0.0, f64::max)
}

/// One of those that were tried, as a step from `before`.
fn step(
    before: &Fitted,
    tried: &[(Candidate, f64)],
    fits: &[(usize, Fitted)],
    index: usize,
    fitted: &Fitted,
) -> Step {
    let (candidate, p_value) = &tried[index];
    let is_rival = |other: usize, fit: &Fitted| {
        !tried[other].0.is_same(candidate) && fit.held_chi2() < before.held_chi2()
    };
    let scale = fits.first().map_or(1.0, |(_, first)| first.scale());
    let held_gain = before.held_chi2() - fitted.held_chi2();
    // Neighbouring residuals are alike, and no law is obeyed to the last per mille: a likelihood would be far too sure of itself.
    // What is missed still may favour either.
    let doubt = DOUBT.max(DOUBT_SHARE * held_gain / scale).max(DOUBT_LEFT * fitted.held_misfit() / scale);
    // As Akaike counts: each parameter more must earn two.
    let cost =
        |index: usize, fit: &Fitted| fit.held_chi2() / scale + 2.0 * tried[index].0.values.len() as f64;
    let own = cost(index, fitted);
    let rivals = fits.iter().filter(|(other, fit)| is_rival(*other, fit));
    Step {
        candidate: candidate.clone(),
        p_value: *p_value,
        gain: before.at.total() - fitted.at.total(),
        held_gain_percent: before.held_gain_percent(fitted),
        proof: Proof::HeldOut,
        rivals: rivals
            .map(|(other, fit)| (tried[*other].0.clone(), (cost(*other, fit) - own) / doubt))
            .collect(),
    }
}
