//! Backward elimination, and nested laws that take the place of simpler ones: by the criterion of selection.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError,
    comparison::{self, Evaluation},
};

use crate::{
    candidates::{self, Candidate},
    context::{self, Context, FittedModel},
    criterion,
    selection::{EXCESS, Path},
};

/// Legs of a fit without a term: iterations, and how near it must come to the fit with it to be gone on with.
const WITHOUT: [(usize, f64); 2] = [(2, 100.0), (4, 2.0)];
/// The same of each start of a nested law.
const UPGRADING: [(usize, f64); 2] = [(2, 4.0), (4, 2.0)];

/// Share of the excess over sensor noise at the last attempt below which nested laws are tried again.
const MUCH_LESS: f64 = 0.5;

impl Path {
    /// Takes out terms, of the first so many the latest first, without which the model predicts as well to within a standard error.
    pub(crate) fn eliminate(&mut self, context: &Context<'_>, first: usize) -> Result<(), IdentifyError> {
        for index in (0..first).rev() {
            let Some(without) = self.fitted_without(context, index)? else { continue };
            let gained = self.gain(&self.last, &without);
            if gained.log_score <= gained.std {
                self.remove(context, index, without)?;
            }
        }
        Ok(())
    }

    /// The last model without a term, at its fit; `None` where that stays far from the fit with it.
    pub(crate) fn fitted_without(
        &self,
        context: &Context<'_>,
        index: usize,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let Some((model, values)) = self.begun_without(index) else { return Ok(None) };
        let problem = context.problem(&model)?;
        let at = context::down(&problem, &self.noise, &values, self.last.deviance(), &WITHOUT)?;
        let Some(at) = at else { return Ok(None) };
        context.fitted(&model, &at.values, Some((&model, &at)), &self.noise)
    }

    /// The last model without a term, fitted from the file's values however far that ends from the fit with it.
    pub(crate) fn refitted_without(
        &self,
        context: &Context<'_>,
        index: usize,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let Some((model, _)) = self.begun_without(index) else { return Ok(None) };
        context.fitted(&model, &model.values(), None, &self.noise)
    }

    /// The last model with a term's amplitude at its null value, everything else as it is.
    pub(crate) fn without(
        &self,
        context: &Context<'_>,
        index: usize,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let Some((model, values)) = self.begun_without(index) else { return Ok(None) };
        let at = comparison::measure(&context.problem(&model)?, &self.noise, &values)?;
        at.map_or(Ok(None), |at| context.validated(&model, at, &self.noise))
    }

    /// Goes on without a term.
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

    /// Takes out terms whose place a curve takes: beside it they are not worth it.
    pub(crate) fn replace_by_curve(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        for index in (0..self.terms.len()).rev() {
            let Some(curve) = &self.unexplained else { return Ok(()) };
            let Some((model, values)) = self.begun_without(index) else { continue };
            let Some(beside) = curve.beside(context, (&model, &values), &self.noise)? else { continue };
            let Some(all) = context.refitted(&curve.fitted, &self.noise)? else { continue };
            let gained = self.gain(&all, &beside);
            if gained.log_score > gained.std {
                continue;
            }
            let Some(fitted) = context.fitted(&model, &values, None, &self.noise)? else { continue };
            let named = self.clone();
            let curve = curve.clone();
            self.remove(context, index, fitted)?;
            self.unexplained = curve.again(context, self)?;
            if self.unexplained.is_none() {
                *self = named;
            }
        }
        Ok(())
    }

    /// Puts the simplest law in a term's place beside which the term's own gains nothing.
    pub(crate) fn simplify(&mut self, context: &Context<'_>, index: usize) -> Result<(), IdentifyError> {
        for simpler in candidates::simpler_laws(self, index) {
            let Some((model, values)) = self.begun_with(index, &simpler) else { continue };
            let Some(fitted) = context.fitted(&model, &values, None, &self.noise)? else { continue };
            let gained = self.gain(&self.last, &fitted);
            if gained.log_score <= gained.std.max(self.least_of_another_name(index, &simpler)) {
                self.last = fitted;
                let term = &mut self.terms[index];
                term.rivals.retain(|(rival, _)| !rival.is_same(&simpler));
                term.candidate = simpler;
                return Ok(());
            }
        }
        Ok(())
    }

    /// What a term's law has to gain over another one with another name: more than the simpler law's own discrepancy may make.
    fn least_of_another_name(&self, index: usize, other: &Candidate) -> f64 {
        let term = &self.terms[index];
        if other.effect.id == term.candidate.effect.id { 0.0 } else { criterion::by_law(term.gain.log_score) }
    }

    /// Puts nested laws in the place of simpler ones where they predict better: noise is known only once most of what was missing is there,
    /// so that they are tried again where much less is left.
    pub(crate) fn upgrade(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        for index in 0..self.terms.len() {
            let excess = self.noise.excess();
            if excess > MUCH_LESS * self.terms[index].excess_at_upgrade {
                continue;
            }
            self.terms[index].excess_at_upgrade = excess;
            let first = self.terms[index].candidate.clone();
            for starts in candidates::refined_laws(&first, &self.base.model) {
                self.replace(context, index, starts)?;
            }
            let richer = candidates::richer_laws(self, index);
            self.replace(context, index, richer)?;
        }
        Ok(())
    }

    /// Puts the best of several laws in the place of a term's.
    fn replace(
        &mut self,
        context: &Context<'_>,
        index: usize,
        starts: Vec<Candidate>,
    ) -> Result<(), IdentifyError> {
        if self.noise.excess() < EXCESS {
            return Ok(());
        }
        let Some((candidate, model, at)) = self.best_of(context, index, starts)? else { return Ok(()) };
        let noise = context.noise_at(&model, &at, self.noise.levels())?;
        let noise = noise.unwrap_or_else(|| self.noise.clone());
        let after = context.fitted(&model, &at.values, Some((&model, &at)), &noise)?;
        let before = context.compared(&self.last.model, &self.last.at, &noise)?;
        let Some((after, before)) = after.zip(before) else { return Ok(()) };
        let gained = self.gain(&after, &before);
        if gained.log_score <= gained.std.max(self.least_of_another_name(index, &candidate)) {
            return Ok(());
        }
        (self.last, self.noise) = (after, noise);
        let term = &mut self.terms[index];
        term.rivals.retain(|(rival, _)| !rival.is_same(&candidate));
        term.candidate = candidate;
        Ok(())
    }

    /// The last model with another law in the place of a term's, from the best of several starts.
    fn best_of(
        &self,
        context: &Context<'_>,
        index: usize,
        starts: Vec<Candidate>,
    ) -> Result<Option<(Candidate, socam_model::Model, Evaluation)>, IdentifyError> {
        let begun = starts.into_par_iter().map(|start| {
            let Some((model, values)) = self.begun_with(index, &start) else { return Ok(None) };
            let best = self.last.deviance();
            let at = context::down(&context.problem(&model)?, &self.noise, &values, best, &UPGRADING)?;
            Ok(at.map(|at| (start, model, at)))
        });
        let begun: Result<Vec<_>, IdentifyError> = begun.collect();
        Ok(begun?.into_iter().flatten().min_by(|a, b| a.2.total().total_cmp(&b.2.total())))
    }
}
