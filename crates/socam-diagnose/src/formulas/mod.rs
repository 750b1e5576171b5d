//! A formula in the place of a curve that no effect of the catalogue explains.
//!
//! Every formula of a small grammar is compared with the points of the curve; the likeliest are fitted to the recordings in the curve's place
//! and compared by the criterion by which all models are. The simplest is taken that is within one standard error of the best, or within what a law's
//! discrepancy can make, unless the curve predicts better than the best: then there is no formula.

mod fit;
mod grammar;
mod screening;

use rayon::prelude::*;
use socam_identify::{IdentifyError, comparison::NoiseModel};

use crate::{
    context::{Context, FittedModel},
    criterion,
    document::RivalFormula,
    nonparametric::{formula::FoundFormula, term::Unexplained},
    selection::Path,
};
use fit::Candidate;
use screening::Points;

/// Least difference of log scores that counts as one.
const LEAST_DIFFERENCE: f64 = 1.0;

/// The formula that predicts as well as a curve; `None` where there is none, the curve repeats with each turn (its harmonics are a formula), or
/// the search was ended.
pub(crate) fn in_place_of(
    context: &Context<'_>,
    path: &Path,
    curve: &Unexplained,
) -> Result<Option<FoundFormula>, IdentifyError> {
    let Some(over) = curve.coordinate() else { return Ok(None) };
    let terms = if over.is_time { grammar::over_time() } else { grammar::over_a_coordinate() };
    let forms = screening::likeliest(&Points::of(curve, &over), &terms);
    let fitted = forms.par_iter().map(|form| Candidate::fitted(context, path, (curve, &over), form));
    let all: Result<Vec<Option<Candidate>>, IdentifyError> = fitted.collect();
    let mut all: Vec<Candidate> = all?.into_iter().flatten().collect();
    let noise = noise(context, path, curve, &all)?;
    all = again(context, &noise, all)?;
    let compared = |own: &FittedModel| context.compared(&own.model, &own.at, &noise);
    let (Some(curve), Some(before)) = (compared(&curve.fitted)?, compared(&path.last)?) else {
        return Ok(None);
    };
    let gained = |own: &FittedModel| path.gain(own, &before).log_score;
    let best = all.iter().max_by(|a, b| gained(&a.fitted).total_cmp(&gained(&b.fitted)));
    let Some(best) = best.map(|best| best.fitted.clone()) else { return Ok(None) };
    // Smaller differences than a law's discrepancy can make are not evidence for one formula, or for the curve.
    let by_law = criterion::by_law(gained(&best)).max(LEAST_DIFFERENCE);
    let less = path.gain(&curve, &best);
    if context.stops() || less.log_score > less.std.max(by_law) {
        return Ok(None);
    }
    // The simplest that predicts as well as the best comes first.
    let price = |own: &Candidate| {
        let less = path.gain(&best, &own.fitted);
        let is_far = less.log_score > less.std.max(by_law);
        (is_far, if is_far { 0 } else { own.parameters }, less.log_score)
    };
    all.sort_by(|a, b| {
        let (a, b) = (price(a), price(b));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    });
    for (index, own) in all.iter().enumerate().filter(|(_, own)| !price(own).0) {
        let Some(law) = own.determined(context, &noise)? else { continue };
        let rival = |formula: &str, fitted: &FittedModel| {
            let less = path.gain(&own.fitted, fitted);
            RivalFormula { formula: formula.to_owned(), less: [less.log_score, less.std] }
        };
        let others = all.iter().enumerate().filter(|(other, _)| *other != index);
        let others = others.map(|(_, other)| rival(&other.law.formula, &other.fitted));
        let rivals = [rival("curve", &curve)].into_iter().chain(others).collect();
        return Ok(Some(FoundFormula { law, fitted: own.fitted.clone(), rivals }));
    }
    Ok(None)
}

/// The noise model under which all are compared: that of the fit with the least deviance.
fn noise(
    context: &Context<'_>,
    path: &Path,
    curve: &Unexplained,
    all: &[Candidate],
) -> Result<NoiseModel, IdentifyError> {
    let each = all.iter().map(|own| &own.fitted).chain([&curve.fitted]);
    let closest = each.min_by(|a, b| a.deviance().total_cmp(&b.deviance()));
    let own = match closest {
        Some(fitted) => context.noise_at(&fitted.model, &fitted.at, path.noise.levels())?,
        None => None,
    };
    Ok(own.filter(|own| own.excess() < path.noise.excess()).unwrap_or_else(|| path.noise.clone()))
}

/// All fitted again under one noise model, without those whose prediction overflows.
fn again(
    context: &Context<'_>,
    noise: &NoiseModel,
    all: Vec<Candidate>,
) -> Result<Vec<Candidate>, IdentifyError> {
    let each = all.into_par_iter().map(|own| {
        let fitted = context.compared(&own.fitted.model, &own.fitted.at, noise)?;
        Ok(fitted.map(|fitted| Candidate { fitted, ..own }))
    });
    let each: Result<Vec<Option<Candidate>>, IdentifyError> = each.collect();
    Ok(each?.into_iter().flatten().collect())
}
