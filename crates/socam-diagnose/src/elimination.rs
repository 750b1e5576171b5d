//! Backward elimination of terms, and replacement of a term's law by a nested one, both by the criterion of selection.

use rayon::prelude::*;
use socam_identify::{IdentifyError, comparison::Evaluation};
use socam_model::Model;

use crate::{
    candidate::Candidate,
    candidates,
    context::{self, Context, FittedModel},
    criterion,
    drag::{self, Drags},
    extension::carried_over,
    halving,
    journal::{self, Fate},
    nested,
    selection::{EXCESS, Path, Term},
};

/// Rounds of a fit without a term: `(iterations, multiple)` of `descend_in_rounds`, relative to the deviance with the term.
const WITHOUT: [(usize, f64); 2] = [(2, 100.0), (4, 2.0)];
/// Rounds of each start of a nested law, in the same form.
const UPGRADING: [(usize, f64); 2] = [(2, 4.0), (4, 2.0)];
/// Number of starts that have more than the first of these rounds.
const CONTINUED: usize = 2;

/// Share of the excess at the last attempt below which nested laws are tried again.
const RETRY_SHARE: f64 = 0.5;

/// A law that contains a term's law and did not take its place.
struct Richer {
    law: Candidate,
    /// Its share of the term's weight.
    share: f64,
    /// Drag of the bearing with it.
    drags: Option<Drags>,
}

impl Term {
    /// Keeps a law that contains the term's law. Another form of the same effect has the same name, and only its drag is kept.
    fn keep(&mut self, richer: Richer) {
        self.drags.extend(richer.drags);
        self.richer.retain(|(known, _)| !known.is_same(&richer.law));
        if !self.candidate.is_same(&richer.law) {
            self.richer.push((richer.law, richer.share));
        }
    }
}

impl Path {
    /// Removes terms among the first `first`, the latest first, if the model without them predicts as well to within a standard error.
    pub(crate) fn eliminate(&mut self, context: &Context<'_>, first: usize) -> Result<(), IdentifyError> {
        for index in (0..first).rev() {
            let Some(without) = self.fitted_without(context, index)? else { continue };
            if context.stops() {
                break;
            }
            let gained = self.gain(&self.last, &without);
            if !Self::is_better(&self.noise, gained, (&self.last, &without)) {
                context.journal.note(&self.terms[index].candidate, Fate::Superfluous(gained));
                self.remove(context, index, without)?;
            }
        }
        Ok(())
    }

    /// The last model without a term, at its fit from the last values; `None` where its deviance stays far above that with the term.
    pub(crate) fn fitted_without(
        &self,
        context: &Context<'_>,
        index: usize,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let Some((model, values)) = self.start_without(index) else { return Ok(None) };
        let problem = context.problem(&model)?;
        let at = context::descend_in_rounds(&problem, &self.noise, &values, self.last.deviance(), &WITHOUT)?;
        let Some(at) = at else { return Ok(None) };
        context.fitted(&model, &at.values, Some((&model, &at)), &self.noise)
    }

    /// The last model without a term, whatever its deviance: the better fit from the file's values and from those of the base model, which
    /// several starts led to.
    pub(crate) fn refitted_without(
        &self,
        context: &Context<'_>,
        index: usize,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let Some((model, _)) = self.start_without(index) else { return Ok(None) };
        let base = carried_over((&self.base.model, &self.base.at.values), &model);
        let from_base =
            context.fitted(&model, &base, Some((&self.base.model, &self.base.at)), &self.noise)?;
        let from_file = context.fitted(&model, &model.values(), None, &self.noise)?;
        Ok([from_base, from_file].into_iter().flatten().min_by(|a, b| a.deviance().total_cmp(&b.deviance())))
    }

    /// The last model with a term's amplitude at its null value and everything else unchanged, cross-validated.
    pub(crate) fn validated_without(
        &self,
        context: &Context<'_>,
        index: usize,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let without = self.evaluated_without(context, index, &self.noise)?;
        without.map_or(Ok(None), |(model, at)| context.validated(&model, at, &self.noise))
    }

    /// Removes a term; `without` is the model without it at its fit.
    pub(crate) fn remove(
        &mut self,
        context: &Context<'_>,
        index: usize,
        without: FittedModel,
    ) -> Result<(), IdentifyError> {
        self.terms.remove(index);
        self.last = without;
        self.tests.clear();
        self.renew_noise(context)
    }

    /// Removes terms that gain nothing if the nonparametric term is in the model.
    pub(crate) fn replace_by_curve(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        for index in (0..self.terms.len()).rev() {
            let Some(curve) = &self.unexplained else { return Ok(()) };
            let Some((model, values)) = self.start_without(index) else { continue };
            let Some(beside) = curve.beside(context, (&model, &values), &self.noise)? else { continue };
            let Some(all) = context.refitted(&curve.fitted, &self.noise)? else { continue };
            let gained = self.gain(&all, &beside);
            if gained.log_score > gained.std {
                continue;
            }
            let Some(fitted) = context.fitted(&model, &values, None, &self.noise)? else { continue };
            if context.stops() {
                break;
            }
            let named = self.clone();
            let curve = curve.clone();
            self.remove(context, index, fitted)?;
            self.unexplained = curve.fitted_again(context, self)?;
            if self.unexplained.is_none() {
                *self = named;
            } else {
                let by = "a curve without a law".to_owned();
                context.journal.note(&named.terms[index].candidate, Fate::Replaced { by });
            }
        }
        Ok(())
    }

    /// Replaces a term's law by the simplest law over which it gains nothing.
    pub(crate) fn simplify(&mut self, context: &Context<'_>, index: usize) -> Result<(), IdentifyError> {
        for simpler in nested::simpler_laws(self, index) {
            let Some((model, values)) = self.start_with(index, &simpler) else { continue };
            let Some(fitted) = context.fitted(&model, &values, None, &self.noise)? else { continue };
            if context.stops() {
                break;
            }
            let gained = self.gain(&self.last, &fitted);
            let is_needed = Self::is_better(&self.noise, gained, (&self.last, &fitted))
                && gained.log_score > self.least_gain_over(index)(&simpler);
            if !is_needed {
                let law = self.terms[index].candidate.clone();
                let richer = self.richer(context, index, (law, &self.last), &fitted);
                self.last = fitted;
                self.take_law(context, index, simpler);
                self.terms[index].keep(richer);
                break;
            }
        }
        Ok(())
    }

    /// Log score that a term's law has to gain over another effect's law: more than the simpler law's discrepancy can make. 0 for a law of
    /// the same effect.
    fn least_gain_over(&self, index: usize) -> impl Fn(&Candidate) -> f64 + use<> {
        let (own, discrepancy) =
            (self.terms[index].candidate.effect.id, criterion::by_law(self.terms[index].gain.log_score));
        move |other| if other.effect.id == own { 0.0 } else { discrepancy }
    }

    /// Replaces terms' laws by laws that contain them and predict better. Noise levels are known only once most missing physics was added,
    /// so a law is tried again when the excess has fallen below [`RETRY_SHARE`].
    pub(crate) fn upgrade(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        for index in 0..self.terms.len() {
            let excess = self.noise.excess();
            let is_left = excess >= EXCESS && excess <= RETRY_SHARE * self.terms[index].excess_at_upgrade;
            if !is_left || context.stops() {
                continue;
            }
            self.terms[index].excess_at_upgrade = excess;
            self.enrich(context, index, self.least_gain_over(index))?;
        }
        Ok(())
    }

    /// Replaces the laws of the terms at a place, where a curve predicts better than they do, by laws that contain them. Returns whether one
    /// was replaced. What a law may be wrong by is no reason to keep it here, because the curve has more than that to explain.
    pub(crate) fn exchange_laws_at(
        &mut self,
        context: &Context<'_>,
        place: &str,
    ) -> Result<bool, IdentifyError> {
        let here: Vec<usize> =
            (0..self.terms.len()).filter(|index| self.terms[*index].candidate.place == place).collect();
        let mut is_exchanged = false;
        for index in here {
            is_exchanged |= self.enrich(context, index, |_| 0.0)?;
        }
        if is_exchanged {
            self.tests.clear();
        }
        Ok(is_exchanged)
    }

    /// Replaces a term's law by its refined form, and then by a law that contains it, where each predicts better by more than `least` says.
    /// Returns whether one does.
    fn enrich(
        &mut self,
        context: &Context<'_>,
        index: usize,
        least: impl Fn(&Candidate) -> f64,
    ) -> Result<bool, IdentifyError> {
        let mut is_replaced = false;
        for starts in nested::refined_laws(&self.terms[index].candidate, &self.base.model) {
            is_replaced |= self.replace(context, index, starts, &least)?;
        }
        let richer = nested::richer_laws(self, index, &self.candidates(context)?);
        is_replaced |= self.replace(context, index, richer, least)?;
        Ok(is_replaced)
    }

    /// Replaces a term's law by the best of several laws, if it predicts better by more than a standard error and what `least` says for it.
    /// Returns whether it does.
    fn replace(
        &mut self,
        context: &Context<'_>,
        index: usize,
        starts: Vec<Candidate>,
        least: impl Fn(&Candidate) -> f64,
    ) -> Result<bool, IdentifyError> {
        if context.stops() {
            return Ok(false);
        }
        let Some((candidate, model, values)) = self.best_of(context, index, starts)? else {
            return Ok(false);
        };
        let problem = context.tentative(&model)?;
        let best = self.last.deviance();
        let at = context::descend_in_rounds(&problem, &self.noise, &values, best, &UPGRADING)?;
        let Some(at) = at else { return Ok(false) };
        let noise = context.noise_at(&model, &at, self.noise.levels())?;
        let noise = noise.unwrap_or_else(|| self.noise.clone());
        let after = context.compared(&model, &at, &noise)?;
        let before = context.compared(&self.last.model, &self.last.at, &noise)?;
        let Some((after, before)) = after.zip(before).filter(|_| !context.stops()) else { return Ok(false) };
        let gained = self.gain(&after, &before);
        if gained.log_score <= gained.std.max(least(&candidate)) {
            let richer = self.richer(context, index, (candidate, &after), &before);
            self.terms[index].keep(richer);
            return Ok(false);
        }
        (self.last, self.noise) = (after, noise);
        self.take_law(context, index, candidate);
        Ok(true)
    }

    /// All candidates on this machine, those of terms and their equivalents included.
    fn candidates(&self, context: &Context<'_>) -> Result<Vec<Candidate>, IdentifyError> {
        Ok(candidates::all(&self.last.model, &self.scales(context)?))
    }

    /// Puts another law in a term's place.
    fn take_law(&mut self, context: &Context<'_>, index: usize, law: Candidate) {
        let term = &mut self.terms[index];
        if !term.candidate.is_same(&law) {
            context.journal.note(&term.candidate, Fate::Replaced { by: journal::named(&law) });
        }
        term.rivals.retain(|(rival, _)| !rival.is_same(&law));
        term.richer.retain(|(richer, _)| !richer.is_same(&law) && richer.contains(&law));
        term.candidate = law;
    }

    /// A law that contains a term's law, beside it; `rich` and `simple` are the models with the two laws.
    fn richer(
        &self,
        context: &Context<'_>,
        index: usize,
        (law, rich): (Candidate, &FittedModel),
        simple: &FittedModel,
    ) -> Richer {
        let models = [self.scored(simple), self.scored(rich)];
        let weights = criterion::weights(&models, self.terms[index].gain.log_score, context.options.seed);
        Richer { share: weights[1], drags: drag::of_fit(self, rich, &law), law }
    }

    /// Replaces a term's law in the last model by another law, fits a few rounds from each of several starts to an excerpt of long recordings,
    /// and returns the fit with the least deviance there: candidate, model and values. `None` where none leaves clearly less than the term's law.
    fn best_of(
        &self,
        context: &Context<'_>,
        index: usize,
        starts: Vec<Candidate>,
    ) -> Result<Option<(Candidate, Model, Vec<f64>)>, IdentifyError> {
        if starts.is_empty() {
            return Ok(None);
        }
        let Some(last) = context.fitted_in_brief(&self.last, &self.noise)? else { return Ok(None) };
        let descend = |model: &Model, values: &[f64], round: usize| {
            let rounds = std::slice::from_ref(&UPGRADING[round]);
            context::descend_in_rounds(&context.brief(model)?, &self.noise, values, last.total(), rounds)
        };
        let begun = starts.into_par_iter().map(|start| {
            let Some((model, values)) = self.start_with(index, &start) else { return Ok(None) };
            let at = descend(&model, &values, 0)?;
            Ok(at.map(|at| (start, model, at)))
        });
        let begun: Result<Vec<Option<_>>, IdentifyError> = begun.collect();
        let mut begun: Vec<(Candidate, Model, Evaluation)> = begun?.into_iter().flatten().collect();
        begun.sort_by(|a, b| a.2.total().total_cmp(&b.2.total()));
        begun.truncate(CONTINUED);
        let ended = begun.into_par_iter().map(|(start, model, at)| {
            let at = descend(&model, &at.values, 1)?;
            Ok(at.map(|at| (start, model, at)))
        });
        let ended: Result<Vec<Option<_>>, IdentifyError> = ended.collect();
        let best = ended?.into_iter().flatten().min_by(|a, b| a.2.total().total_cmp(&b.2.total()));
        let best = best.filter(|(.., at)| last.total() - at.total() > halving::least_fall(&last));
        Ok(best.map(|(start, model, at)| (start, model, at.values)))
    }
}
