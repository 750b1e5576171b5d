//! What all fits share, and a model at its fit.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError, NoiseLevels, Options as FitOptions, Problem,
    compare::{self, Measured, Yardstick},
};
use socam_model::Model;
use socam_recording::Dataset;

use crate::{Options, candidates::Candidate, document::Validation, validation::Folds};

/// Iterations of a fit in earnest, and of one that only follows another choice of recordings.
const ITERATIONS: usize = 25;
const FOLLOWING: usize = 6;
/// Mean square of what is left on held-out recordings, in units of noise, below which that was overrated.
const QUIETER: f64 = 0.8;

/// A model at its best fit, and how it predicts what it was not fitted to.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    pub(crate) model: Model,
    pub(crate) at: Measured,
    /// On held-out recordings, fold by fold.
    pub(crate) held: Vec<Measured>,
}

impl Fitted {
    pub(crate) fn held_chi2(&self) -> f64 {
        self.held.iter().map(Measured::total).sum()
    }

    fn count(&self) -> f64 {
        self.at.count.iter().sum()
    }

    fn held_count(&self) -> f64 {
        self.held.iter().flat_map(|measured| &measured.count).sum()
    }

    /// How much of what it leaves there beyond noise another one takes away, per cent.
    pub(crate) fn held_gain_percent(&self, other: &Self) -> f64 {
        let gain = self.held_chi2() - other.held_chi2();
        100.0 * gain / self.held_misfit().max(gain).max(1.0)
    }

    /// What it leaves on held-out recordings beyond noise.
    pub(crate) fn held_misfit(&self) -> f64 {
        (self.held_chi2() - self.held_count()).max(0.0)
    }

    /// What it leaves on all recordings beyond noise. Noise was judged in training: where it is clearly less on held-out recordings,
    /// part of it was none.
    pub(crate) fn left(&self) -> f64 {
        let (count, held_count) = (self.count(), self.held_count());
        let held = self.held_scale();
        let floor = if held < QUIETER { held } else { 1.0 };
        let each = [(self.at.total(), count), (self.held_chi2(), held_count)];
        each.map(|(total, count)| (total - floor * count).max(0.0)).iter().sum()
    }

    /// What it leaves on training recordings beyond noise.
    pub(crate) fn misfit(&self) -> f64 {
        (self.at.total() - self.count()).max(0.0)
    }

    /// Its model with effects added, at their candidates' values.
    pub(crate) fn with<'c>(&self, mut added: impl Iterator<Item = &'c Candidate>) -> Option<Model> {
        added.try_fold(self.model.clone(), |model, candidate| {
            model.with_effect(candidate.effect.id, &candidate.place, &candidate.values).ok()
        })
    }

    /// Mean square of what it leaves on held-out recordings, in units of noise; at least one.
    pub(crate) fn scale(&self) -> f64 {
        self.held_scale().max(1.0)
    }

    /// The same; less than one where noise is overrated, as it is while much is missing.
    pub(crate) fn held_scale(&self) -> f64 {
        self.held_chi2() / self.held_count().max(1.0)
    }

    /// Mean square of what it leaves on training recordings, in units of noise; at least one.
    pub(crate) fn training_scale(&self) -> f64 {
        (self.at.total() / self.count().max(1.0)).max(1.0)
    }
}

/// Recordings and assumptions that all fits share.
pub(crate) struct Bench<'a> {
    pub(crate) training: &'a [Dataset],
    pub(crate) folds: &'a Folds,
    pub(crate) fit: FitOptions,
    pub(crate) options: &'a Options,
}

impl Bench<'_> {
    /// Whether what a model leaves may well be noise: within three standard deviations of chi-square's. Where recordings are left out
    /// in turn, only training counts: what the others do not determine is missed too.
    pub(crate) fn is_at_noise(&self, fitted: &Fitted) -> bool {
        let (left, count) = match self.folds.kind {
            Validation::Holdout => (fitted.left(), fitted.count() + fitted.held_count()),
            _ => (fitted.misfit(), fitted.count()),
        };
        left < 3.0 * (2.0 * count).sqrt()
    }

    pub(crate) fn problem<'m>(&'m self, model: &'m Model) -> Result<Problem<'m>, IdentifyError> {
        Problem::new(model, self.training, self.fit.clone())
    }

    pub(crate) fn yardstick(
        &self,
        model: &Model,
        values: &[f64],
        levels: NoiseLevels,
    ) -> Result<Yardstick, IdentifyError> {
        let training = self.problem(model)?;
        let held: Result<Vec<_>, _> = self
            .folds
            .folds
            .iter()
            .map(|fold| Problem::new(model, &fold.held_out, self.fit.clone()))
            .collect();
        let held = held?;
        let problems: Vec<&Problem<'_>> = std::iter::once(&training).chain(&held).collect();
        Yardstick::new(&problems, values, levels)
    }

    /// Fits a model, beginning at `values`, to all recordings and, where these are held out in turn, to each choice of them.
    pub(crate) fn fitted(
        &self,
        model: &Model,
        values: &[f64],
        from: Option<&Fitted>,
        yardstick: &Yardstick,
    ) -> Result<Option<Fitted>, IdentifyError> {
        let before = from.map(|from| (&from.model, &from.at));
        let at =
            compare::descend(&self.problem(model)?, yardstick, values, before, (compare::FINE, ITERATIONS))?;
        at.map_or(Ok(None), |at| self.held(model, at, yardstick))
    }

    /// The same fit by another yardstick.
    pub(crate) fn measured(
        &self,
        fitted: &Fitted,
        yardstick: &Yardstick,
    ) -> Result<Option<Fitted>, IdentifyError> {
        let model = &fitted.model;
        let at = compare::measure(&self.problem(model)?, yardstick, &fitted.at.values)?;
        let held = self.folds.folds.iter().zip(&fitted.held).map(|(fold, held)| {
            let problem = Problem::new(model, &fold.held_out, self.fit.clone())?;
            compare::measure(&problem, yardstick, &held.values)
        });
        let held: Result<Option<Vec<Measured>>, IdentifyError> = held.collect();
        Ok(at.zip(held?).map(|(at, held)| Fitted { model: model.clone(), at, held }))
    }

    /// How a model that was fitted predicts what it was not fitted to.
    pub(crate) fn held(
        &self,
        model: &Model,
        at: Measured,
        yardstick: &Yardstick,
    ) -> Result<Option<Fitted>, IdentifyError> {
        let held = self.folds.folds.par_iter().map(|fold| {
            let values = if self.folds.kind == Validation::Holdout {
                at.values.clone()
            } else {
                let own = Problem::new(model, &fold.fitted, self.fit.clone())?;
                match compare::descend(&own, yardstick, &at.values, None, (compare::COARSE, FOLLOWING))? {
                    Some(own) => own.values,
                    None => return Ok(None),
                }
            };
            let held_out = Problem::new(model, &fold.held_out, self.fit.clone())?;
            compare::measure(&held_out, yardstick, &values)
        });
        let held: Result<Vec<Option<Measured>>, IdentifyError> = held.collect();
        let held: Option<Vec<Measured>> = held?.into_iter().collect();
        Ok(held.map(|held| Fitted { model: model.clone(), at, held }))
    }
}
