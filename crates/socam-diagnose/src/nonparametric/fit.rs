//! Score and fit of nonparametric terms.

use socam_identify::{
    IdentifyError,
    comparison::{self, CandidateScore, NoiseModel},
};
use socam_model::{Model, ModelError};

use super::{
    basis::{ANY, transition},
    term::{NonparametricTerm, ScoredTerm, Unexplained},
};
use crate::{
    choice::Choice,
    context::{Context, FittedModel},
    criterion,
    extension::{carried_over, free_parameters},
    selection::Path,
};

/// Largest number of iterations of a nonparametric term's fit.
const ITERATIONS: usize = 10;

/// The model with a term's basis functions at height zero, and the indices of their heights.
fn with_basis(model: &Model, term: &NonparametricTerm) -> Result<(Model, Vec<usize>), ModelError> {
    let mut grown = model.clone();
    let mut heights = Vec::new();
    let transition = transition(model.motion);
    for [first, second, third] in term.basis() {
        let all = [0.0, first, second, third, transition];
        grown = grown.with_law(term.effect, &term.place, &all[..term.effect.parameters.len()])?;
        let height = grown.effects.last().map(|used| used.parameters[0]);
        heights.extend(height);
    }
    for height in &heights {
        grown.parameters[*height].fixed = false;
        grown.parameters[*height].bounds = ANY;
    }
    Ok((grown, heights))
}

/// Scores of a few terms from one evaluation, without terms that cannot act.
pub(super) fn scored_batch(
    context: &Context<'_>,
    path: &Path,
    terms: &[NonparametricTerm],
) -> Result<Vec<(NonparametricTerm, CandidateScore)>, IdentifyError> {
    let last = &path.last;
    let (mut model, mut heights, mut acting) = (last.model.clone(), Vec::new(), Vec::new());
    for term in terms {
        if let Ok((grown, own)) = with_basis(&model, term) {
            model = grown;
            heights.push(own);
            acting.push(term.clone());
        }
    }
    let values = carried_over((&last.model, &last.at.values), &model);
    let problem = context.tentative(&model)?;
    let base = free_parameters(&last.model, &model);
    let from = (&last.model, &last.at);
    let scores = comparison::score_test(&problem, &path.noise, &values, from, &base, &heights)?;
    Ok(acting.into_iter().zip(scores.unwrap_or_default()).collect())
}

/// A term fitted together with the last model, from heights of zero and, where an effect was chosen at its place whose law it can follow, from
/// that law. `None` where the term cannot act or the prediction overflows.
pub(super) fn fitted(
    context: &Context<'_>,
    path: &Path,
    scored: &ScoredTerm,
    named: Option<&Choice>,
) -> Result<Option<Unexplained>, IdentifyError> {
    let (last, term, std) = (&path.last, &scored.term, &scored.score.std);
    let begun = (&last.model, &*last.at.values);
    let from_zero = fitted_with_term(context, begun, &path.noise, (term, std), &[])?;
    let from_law = match named.and_then(|named| Some((&named.fitted, term.heights_of(&named.fitted)?))) {
        Some((FittedModel { model, at, .. }, heights)) => {
            fitted_with_term(context, (model, &at.values), &path.noise, (term, std), &heights)?
        }
        None => None,
    };
    let both = [from_zero, from_law].into_iter().flatten();
    let Some((fitted, heights)) = both.min_by(|a, b| a.0.deviance().total_cmp(&b.0.deviance())) else {
        return Ok(None);
    };
    let excess = (last.deviance() * path.noise.excess()).max(1.0);
    Ok(Some(Unexplained {
        place: term.place.clone(),
        curve: term.curve(&last.model, &heights, std),
        p_value: scored.p_value,
        gain: path.gain(&fitted, last),
        misfit_percent: (100.0 * (last.deviance() - fitted.deviance()) * path.noise.excess() / excess)
            .clamp(0.0, 100.0),
        term: term.clone(),
        std: std.clone(),
        heights,
        fitted,
        formula: None,
    }))
}

impl Unexplained {
    /// Whether the term predicts better than the chosen effect, by more than a standard error and by more than a law's discrepancy can
    /// make. Both are compared under the noise model of the one with the smaller excess.
    pub(crate) fn beats(
        &self,
        context: &Context<'_>,
        path: &Path,
        named: &Choice,
    ) -> Result<bool, IdentifyError> {
        let FittedModel { model, at, .. } = &self.fitted;
        let own = context.noise_at(model, at, path.noise.levels())?;
        let noise =
            own.filter(|own| own.excess() < named.noise.excess()).unwrap_or_else(|| named.noise.clone());
        let again = |fitted: &FittedModel| context.compared(&fitted.model, &fitted.at, &noise);
        let all = [again(&self.fitted)?, again(&named.fitted)?, again(&named.before)?];
        let [Some(curve), Some(named), Some(before)] = all else { return Ok(false) };
        let (worse, gained) = (path.gain(&curve, &named), path.gain(&curve, &before));
        Ok(worse.log_score > worse.std.max(criterion::by_law(gained.log_score)))
    }

    /// Another model with the same term, fitted from `values`.
    pub(crate) fn beside(
        &self,
        context: &Context<'_>,
        (model, values): (&Model, &[f64]),
        noise: &NoiseModel,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let fitted = fitted_with_term(context, (model, values), noise, (&self.term, &self.std), &[])?;
        Ok(fitted.map(|(fitted, _)| fitted))
    }

    /// This term fitted again to a path that has changed; `None` where it no longer gains more than a standard error.
    pub(crate) fn fitted_again(
        &self,
        context: &Context<'_>,
        path: &Path,
    ) -> Result<Option<Self>, IdentifyError> {
        let found = scored_batch(context, path, std::slice::from_ref(&self.term))?;
        let Some((term, score)) = found.into_iter().next() else { return Ok(None) };
        let scored = ScoredTerm { term, score, p_value: self.p_value };
        Ok(fitted(context, path, &scored, None)?.filter(|curve| curve.gain.log_score > curve.gain.std))
    }
}

/// A model with a term at its fit, and the fitted heights of its basis functions, which begin at `begun`, or at zero where that is empty; `None`
/// also where the search is ended.
fn fitted_with_term(
    context: &Context<'_>,
    (model, values): (&Model, &[f64]),
    noise: &NoiseModel,
    (term, std): (&NonparametricTerm, &[f64]),
    begun: &[f64],
) -> Result<Option<(FittedModel, Vec<f64>)>, IdentifyError> {
    let Ok((mut grown, heights)) = with_basis(model, term) else { return Ok(None) };
    // A height that the recordings do not determine stays zero.
    for (height, std) in heights.iter().zip(std) {
        grown.parameters[*height].fixed = !std.is_finite();
    }
    let mut values = carried_over((model, values), &grown);
    heights.iter().zip(begun).for_each(|(height, begun)| values[*height] = *begun);
    let problem = context.tentative(&grown)?;
    let at = comparison::descend(&problem, noise, &values, None, (comparison::COARSE, ITERATIONS))?;
    let Some(at) = at.filter(|_| !context.stops()) else { return Ok(None) };
    let found = heights.iter().map(|height| at.values[*height]).collect();
    Ok(context.validated(&grown, at, noise)?.map(|fitted| (fitted, found)))
}
