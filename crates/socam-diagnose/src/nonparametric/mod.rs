//! The nonparametric (basis-expansion) term: misfit that no effect of the catalogue explains, as a curve at the place that explains it
//! best.
//!
//! At every place one unknown torque is tried as a smooth function of one quantity: the place's speed, its angle within a turn, a
//! coupling's twist, or time. A friction torque may depend on time or angle, a coupling's stiffness on time, a sensor's error on its
//! reading or time. Curves over time are left out where recordings share their timing. One evaluation with sensitivities gives the score of each;
//! the best one is fitted.

mod basis;
pub(crate) mod coordinate;
mod fit;
pub(crate) mod formula;
mod law;
pub(crate) mod term;
mod timing;

use rayon::prelude::*;
use socam_identify::{IdentifyError, comparison::CandidateScore};
use socam_model::{Model, Motion, effects::ActsAt};
use socam_recording::Dataset;

use crate::{
    candidate::Candidate,
    candidates::is_part,
    choice::Choice,
    context::Context,
    document::{Curve, Over},
    scales::Scales,
    score_test,
    selection::{EXCESS, Path},
};
use basis::{
    BEARING_ANGLE, BEARING_FRICTION_BY_ANGLE, BEARING_FRICTION_BY_TIME, BEARING_SPEED, BEARING_TIME,
    CHANNEL_GAIN, CHANNEL_READING, CHANNEL_TIME, SPRING_STIFFNESS, SPRING_TWIST,
};
use term::{NonparametricTerm, ScoredTerm, Unexplained};

/// Number of terms that share one evaluation: the basis functions of each add to the cost of a step.
const BATCH: usize = 3;
/// Largest ratio of a fitted term's gain to the gain that its score predicts, 1: a term is linear in its heights.
const BEYOND_SCORE: f64 = 1.5;

/// The nonparametric term that predicts better than the chosen effect `named`, if there is one and the search was not ended. Terms are tried where `named` leaves more
/// than sensor noise, or where no effect was chosen although a candidate is significant (`is_any_significant`).
pub(crate) fn competing(
    context: &Context<'_>,
    path: &Path,
    scales: &Scales,
    named: Option<&Choice>,
    is_any_significant: bool,
) -> Result<Option<Unexplained>, IdentifyError> {
    let excess = named.map_or(path.noise.excess(), |named| named.noise.excess());
    let is_explained = excess < EXCESS;
    if is_explained && named.is_some() {
        return Ok(None);
    }
    let mut terms = all_terms(context, &path.last.model, scales);
    terms.retain(|term| !is_explained || is_any_significant || term.is_outside_catalogue());
    if timing::is_shared(&path.last.model, context.training)? {
        terms.retain(|term| term.over != Over::Time);
    }
    let scored = ranked(context, path, &terms)?;
    if context.stops() {
        return Ok(None);
    }
    let Some(first) = scored.first().filter(|first| first.p_value < context.options.false_alarm_rate) else {
        return Ok(None);
    };
    // A curve over a turn has several harmonics and a named effect has one: the other orders are added in later steps.
    let is_one_of_its_orders = named.is_some_and(|named| {
        let Candidate { place, .. } = &named.term.candidate;
        named.term.candidate.value("order").is_finite()
            && first.term.is_by_turn()
            && *place == first.term.place
    });
    if is_one_of_its_orders {
        return Ok(None);
    }
    let falls_short = |one: &ScoredTerm| {
        named.is_some_and(|named| BEYOND_SCORE * one.score.gain < named.deviance_reduction)
    };
    // In the place of the chosen effect's law, a curve begins at that law, and its score at zero does not count.
    let freed_law =
        named.and_then(|named| scored.iter().find(|one| one.term.heights_of(&named.fitted).is_some()));
    let likeliest = Some(first).filter(|first| !falls_short(first));
    let is_freed_law = |one: &&ScoredTerm| freed_law.is_some_and(|law| std::ptr::eq(*one, law));
    let mut curves = Vec::new();
    for one in likeliest.filter(|one| !is_freed_law(one)).into_iter().chain(freed_law) {
        let curve = fit::fitted(context, path, one, named)?;
        curves.extend(curve.filter(|curve| is_possible(&curve.curve, largest_height(path, &one.term))));
    }
    let best = curves.into_iter().max_by(|a, b| a.gain.log_score.total_cmp(&b.gain.log_score));
    let Some(curve) = best else { return Ok(None) };
    if curve.gain.log_score <= curve.gain.std {
        return Ok(None);
    }
    match named {
        // The curve has more parameters than the effect: unless it fits better, it cannot predict better.
        Some(named) if path.last.deviance() - curve.fitted.deviance() < named.deviance_reduction => Ok(None),
        Some(named) if !curve.beats(context, path, named)? => Ok(None),
        _ => Ok(Some(curve)),
    }
}

/// Largest height that a curve may have: the largest torque at its place, or the largest reading of its channel, SI.
fn largest_height(path: &Path, term: &NonparametricTerm) -> f64 {
    let rig = &path.priors.rig;
    match term.effect.acts_at {
        ActsAt::Bearing => rig.bearing(&term.place).1.torque,
        ActsAt::Spring => rig.spring(&term.place).torque,
        _ => rig.channel(&term.place).largest,
    }
}

/// Whether no point of a curve exceeds `largest` by more than two standard errors. Where `largest` is not known (0), every curve is
/// possible.
fn is_possible(curve: &Curve, largest: f64) -> bool {
    let known = curve.torque.iter().zip(&curve.torque_std).filter_map(|(height, std)| height.zip(*std));
    largest <= 0.0 || known.into_iter().all(|(height, std)| height.abs() - 2.0 * std <= largest)
}

/// The terms with their scores and p-values, the largest gain first.
fn ranked(
    context: &Context<'_>,
    path: &Path,
    terms: &[NonparametricTerm],
) -> Result<Vec<ScoredTerm>, IdentifyError> {
    // An angle may be measured, and gaps in its readings then become gaps of all terms in the same evaluation.
    let (by_turn, others): (Vec<NonparametricTerm>, Vec<NonparametricTerm>) =
        terms.iter().cloned().partition(NonparametricTerm::is_by_turn);
    let chunks: Vec<&[NonparametricTerm]> = by_turn.chunks(BATCH).chain(others.chunks(BATCH)).collect();
    let scored = |terms: &[NonparametricTerm]| {
        if context.stops() { Ok(Vec::new()) } else { fit::scored_batch(context, path, terms) }
    };
    let each = chunks.into_par_iter().map(scored);
    let found: Result<Vec<Vec<(NonparametricTerm, CandidateScore)>>, IdentifyError> = each.collect();
    let found: Vec<(NonparametricTerm, CandidateScore)> = found?.into_iter().flatten().collect();
    let scores: Vec<&CandidateScore> = found.iter().map(|(_, score)| score).collect();
    let p_values = score_test::family_wise(&scores);
    let each =
        found.into_iter().zip(p_values).map(|((term, score), p_value)| ScoredTerm { term, score, p_value });
    let mut ranked: Vec<ScoredTerm> = each.collect();
    ranked.sort_by(|a, b| b.score.gain.total_cmp(&a.score.gain));
    Ok(ranked)
}

/// Every place with every quantity on which a torque or an error there may depend, as far as its range is known.
fn all_terms(context: &Context<'_>, model: &Model, scales: &Scales) -> Vec<NonparametricTerm> {
    let rotates = model.motion == Motion::Rotation;
    let [by_speed, by_torque] = if rotates { ["rad/s", "N m"] } else { ["m/s", "N"] };
    let mut all = Vec::new();
    let mut add = |effect, place: &str, over, unit, range: (f64, f64), scale, height| {
        if range.1 > range.0 {
            all.push(NonparametricTerm { effect, place: place.to_owned(), over, unit, range, scale, height });
        }
    };
    let (starts, ends) =
        (context.training.iter().map(Dataset::start_s), context.training.iter().map(Dataset::end_s));
    let time_s = (starts.fold(f64::INFINITY, f64::min), ends.fold(f64::NEG_INFINITY, f64::max));
    for bearing in &model.bearings {
        let speed = scales.speed(bearing.node);
        add(&BEARING_SPEED, &bearing.name, Over::Speed, by_speed, (-speed, speed), 1.0, 1.0);
        // A term that is periodic in the angle needs a rotating model.
        if rotates {
            let turn = (0.0, std::f64::consts::TAU);
            add(&BEARING_ANGLE, &bearing.name, Over::Angle, "rad", turn, 1.0, 1.0);
            add(&BEARING_FRICTION_BY_ANGLE, &bearing.name, Over::Angle, "rad", turn, 1.0, 1.0);
        }
        add(&BEARING_TIME, &bearing.name, Over::Time, "s", time_s, 1.0, 1.0);
        add(&BEARING_FRICTION_BY_TIME, &bearing.name, Over::Time, "s", time_s, 1.0, 1.0);
    }
    for (index, spring) in model.springs.iter().enumerate().filter(|(_, spring)| is_part(&spring.name)) {
        // The file's stiffness, because a fit does not determine those of two springs in series.
        let (torque, stiffness) = (scales.torque(index), model.parameters[spring.stiffness].value);
        let twist = torque / stiffness;
        add(&SPRING_TWIST, &spring.name, Over::Torque, by_torque, (-twist, twist), stiffness, 1.0);
        add(&SPRING_STIFFNESS, &spring.name, Over::Time, "s", time_s, 1.0, twist);
    }
    for (output, channel) in model.outputs().enumerate() {
        let reading = scales.reading(output);
        let over = match channel.quantity {
            socam_model::Quantity::Torque => Over::Torque,
            socam_model::Quantity::Speed => Over::Speed,
            _ => Over::Angle,
        };
        add(&CHANNEL_READING, &channel.name, over, channel.unit, (-reading, reading), 1.0, 1.0);
        add(&CHANNEL_TIME, &channel.name, Over::Time, "s", time_s, 1.0, 1.0);
        add(&CHANNEL_GAIN, &channel.name, Over::Time, "s", time_s, 1.0, reading);
    }
    all
}
