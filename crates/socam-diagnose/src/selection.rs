//! The state of forward stepwise selection: the [`Path`] from the base model to the corrected one and its [`Term`]s.
//!
//! The steps themselves are in `forward`, `choice` and `elimination`, which import this file.

use socam_identify::{
    IdentifyError, NoiseLevels,
    comparison::{self, Evaluation, NoiseModel},
};
use socam_model::Model;
use socam_recording::Dataset;

use crate::{
    candidate::Candidate,
    context::{Context, FAR_BEYOND_NOISE, FittedModel},
    criterion::{self, Difference, Scored},
    equivalence::equivalents,
    extension::carried_over,
    nonparametric::term::Unexplained,
    plausibility::PriorKnowledge,
    score_test::RankedCandidate,
};

/// Mean square of the whitened residuals, in units of sensor noise, above which curves and nested laws are tried.
pub(crate) const EXCESS: f64 = 1.05;
/// Mean square of the whitened residuals, in units of sensor noise, above which large starts are tried and base parameters start again at
/// the file's values: missing physics may have displaced the base parameters too far for a fit to return.
pub(crate) const DISPLACED: f64 = 2.0;

/// What the search had not examined when it was ended before its own end.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Unexamined {
    /// All candidates beside the terms: their score test on whole recordings was not made.
    Candidates,
    /// These effects and places, whose fits were begun, the first of the score test first.
    Fits(Vec<(&'static str, String)>),
    /// Curves without a law.
    Curves,
    /// Effects that are to take the place of a curve without a law.
    Laws,
    /// What the model predicts without each term.
    Comparisons,
}

impl Unexamined {
    /// The effects and places of candidates, each once.
    pub(crate) fn fits(tried: &[(Candidate, f64)]) -> Self {
        let mut all: Vec<(&'static str, String)> = Vec::new();
        for (candidate, _) in tried {
            let one = (candidate.effect.id, candidate.place.clone());
            if !all.contains(&one) {
                all.push(one);
            }
        }
        Self::Fits(all)
    }
}

/// An effect that was added.
#[derive(Debug, Clone)]
pub(crate) struct Term {
    pub(crate) candidate: Candidate,
    /// Family-wise p-value of the score test, over all candidates.
    pub(crate) p_value: f64,
    /// Competing models and their weights. The term's own weight is one minus their sum.
    pub(crate) rivals: Vec<(Candidate, f64)>,
    /// Laws that contain the term's law and predict no better than it by more than it may be wrong by, and their shares of the term's own weight.
    pub(crate) richer: Vec<(Candidate, f64)>,
    /// Drag of the term's bearing at three speeds by other laws in its place that predict as well, see `drag`.
    pub(crate) drags: Vec<[f64; 3]>,
    /// Gain of the last model over the model without this term.
    pub(crate) gain: Difference,
    /// The last model without this term, at its fit.
    pub(crate) without: Option<FittedModel>,
    /// Excess over sensor noise at which nested laws were last tried in its place.
    pub(crate) excess_at_upgrade: f64,
}

/// The path from the base model to the corrected one.
#[derive(Clone)]
pub(crate) struct Path {
    pub(crate) base: FittedModel,
    pub(crate) last: FittedModel,
    pub(crate) terms: Vec<Term>,
    pub(crate) priors: PriorKnowledge,
    /// Sensor noise and model discrepancy, estimated from the last model's residuals.
    pub(crate) noise: NoiseModel,
    /// The last score test, the largest gain first. Empty where the model has changed since.
    pub(crate) tests: Vec<RankedCandidate>,
    /// The nonparametric term, if one was found.
    pub(crate) unexplained: Option<Unexplained>,
    /// What was not examined, where the search was ended before its own end.
    pub(crate) unexamined: Option<Unexamined>,
}

impl Path {
    /// Gain of one model over another: the difference of their cross-validated log scores plus that of their log priors.
    pub(crate) fn gain(&self, after: &FittedModel, before: &FittedModel) -> Difference {
        let own = criterion::difference(&after.validation, &before.validation);
        let prior = self.priors.log_prior(after) - self.priors.log_prior(before);
        Difference { log_score: own.log_score + prior, ..own }
    }

    /// Whether a model predicts better than another, which it gains `gained` over, by more than a standard error. Where both are far from the
    /// data a log score is that of a few blocks, such as those in which an integrated error has grown most: there it also predicts better if
    /// it leaves less in most blocks. `noise` is the noise model of both.
    pub(crate) fn is_better(
        noise: &NoiseModel,
        gained: Difference,
        (after, before): (&FittedModel, &FittedModel),
    ) -> bool {
        let is_far = noise.excess() >= FAR_BEYOND_NOISE;
        gained.log_score > gained.std
            || is_far
                && gained.log_score > 0.0
                && criterion::leaves_less(&after.validation, &before.validation)
    }

    /// A model with its prior, for a comparison.
    pub(crate) fn scored<'a>(&self, fitted: &'a FittedModel) -> Scored<'a> {
        Scored { validation: &fitted.validation, log_prior: self.priors.log_prior(fitted) }
    }

    /// Number of added effects. Several orders of one effect at one place count once.
    pub(crate) fn effects(&self) -> usize {
        let is_first = |index: &usize| {
            !self.terms[..*index].iter().any(|term| term.candidate.is_same(&self.terms[*index].candidate))
        };
        (0..self.terms.len()).filter(is_first).count()
    }

    /// The last model without one of its terms, and the last fit's values of its parameters.
    pub(crate) fn start_without(&self, index: usize) -> Option<(Model, Vec<f64>)> {
        let others = self.terms.iter().enumerate().filter(|(other, _)| *other != index);
        let model = self.base.extended_by(others.map(|(_, term)| &term.candidate))?;
        let values = carried_over((&self.last.model, &self.last.at.values), &model);
        Some((model, values))
    }

    /// The last model without one of its terms, evaluated at the last fit's values; `None` where its prediction overflows.
    pub(crate) fn evaluated_without(
        &self,
        context: &Context<'_>,
        index: usize,
        noise: &NoiseModel,
    ) -> Result<Option<(Model, Evaluation)>, IdentifyError> {
        let Some((model, values)) = self.start_without(index) else { return Ok(None) };
        let at = comparison::measure(&context.problem(&model)?, noise, &values)?;
        Ok(at.map(|at| (model, at)))
    }

    /// The last model with another candidate in the place of one of its terms, and the last fit's values of its parameters.
    pub(crate) fn start_with(&self, index: usize, candidate: &Candidate) -> Option<(Model, Vec<f64>)> {
        let each = self.terms.iter().enumerate();
        let each = each.map(|(other, term)| if other == index { candidate } else { &term.candidate });
        let model = self.base.extended_by(each)?;
        let values = carried_over((&self.last.model, &self.last.at.values), &model);
        Some((model, values))
    }

    /// The model with all terms and the nonparametric term, at its fit; `None` where nothing was found.
    pub(crate) fn corrected(&self) -> Option<&FittedModel> {
        let named = (!self.terms.is_empty()).then_some(&self.last);
        self.unexplained.as_ref().map(Unexplained::whole).or(named)
    }

    /// The corrected model, or the last fit where nothing was found.
    pub(crate) fn whole(&self) -> &FittedModel {
        self.corrected().unwrap_or(&self.last)
    }

    /// Sensor noise levels, estimated from the residuals of the corrected model.
    pub(crate) fn levels(&self, context: &Context<'_>) -> Result<NoiseLevels, IdentifyError> {
        match &self.unexplained {
            Some(found) => {
                let fitted = found.whole();
                comparison::noise(&context.problem(&fitted.model)?, &fitted.at, self.noise.levels())
            }
            None => Ok(self.noise.levels().clone()),
        }
    }

    /// Parameters of a term: their names, and their indices in the last model.
    pub(crate) fn parameters(&self, term: usize) -> impl Iterator<Item = (&'static str, usize)> + '_ {
        let model = &self.last.model;
        let used = &model.effects[model.effects.len() - self.terms.len() + term];
        used.effect.parameters.iter().zip(&used.parameters).map(|(own, index)| (own.name, *index))
    }

    /// Parameters of a term: their names, and their values at the last fit.
    pub(crate) fn fitted_parameters(&self, term: usize) -> Vec<(&'static str, f64)> {
        self.parameters(term).map(|(name, index)| (name, self.last.at.values[index])).collect()
    }

    /// Effects that are observationally equivalent to a term.
    pub(crate) fn equivalent(&self, context: &Context<'_>, term: usize) -> Vec<Candidate> {
        let candidate = &self.terms[term].candidate;
        let amplitude = candidate.amplitudes.first().and_then(|name| self.value(term, name));
        let step_s = context.training.first().map_or(0.0, Dataset::sample_time_s);
        equivalents(&self.last.model, candidate, amplitude, step_s)
    }

    /// Value of one of a term's parameters at the last fit, SI.
    pub(crate) fn value(&self, term: usize, name: &str) -> Option<f64> {
        let index = self.parameters(term).find(|(own, _)| *own == name)?.1;
        Some(self.last.at.values[index])
    }

    /// Whether an effect at a place was added.
    pub(crate) fn has(&self, candidate: &Candidate) -> bool {
        self.terms.iter().any(|term| term.candidate.is_same(candidate))
    }
}
