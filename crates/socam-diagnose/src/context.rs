//! The cross-validation context: training recordings, their folds and fit settings, which all fits of a diagnosis share.
//!
//! Data have three roles. Training recordings are fitted. Model selection is cross-validation among them: each whole recording is left out
//! in turn, or long blocks where there are fewer than [`FEW`] recordings. Held-out recordings are used only in `proof`.

use std::ops::Range;

use rayon::prelude::*;
use socam_identify::{
    IdentifyError, NoiseLevels, Options as FitOptions, Problem,
    comparison::cross_validation::{self, CrossValidation},
    comparison::{self, Evaluation, Excerpt, NoiseModel},
};
use socam_model::Model;
use socam_recording::{Dataset, RecordingError};

use crate::{
    candidate::Candidate, document::Validation, extension::extended, journal::Journal, options::Options,
    preprocessing::masked,
};

/// Least number of recordings for cross-validation by whole recordings; fewer are cut into blocks.
const FEW: usize = 3;
/// Number of blocks into which fewer recordings are cut, all together.
const BLOCKS: usize = 4;
/// Mean square of the whitened residuals, in units of sensor noise, above which inputs are treated as exact, and above which large starts
/// are tried even after an effect was added.
pub(crate) const FAR_BEYOND_NOISE: f64 = 100.0;
/// Rows of the excerpt on which candidates race.
const EXCERPT_ROWS: u64 = 6000;
/// Largest number of iterations of a fit, of the last fit, and of a refit, which starts at an existing fit.
const ITERATIONS: usize = 12;
const LAST_ITERATIONS: usize = 25;
const REFIT_ITERATIONS: usize = 6;

/// A model, its fit to the training recordings and its cross-validation.
#[derive(Debug, Clone)]
pub(crate) struct FittedModel {
    pub(crate) model: Model,
    pub(crate) at: Evaluation,
    pub(crate) validation: CrossValidation,
}

impl FittedModel {
    /// Sum of squared whitened residuals.
    pub(crate) fn deviance(&self) -> f64 {
        self.at.total()
    }

    /// The model with the effects of candidates added at their values; `None` where one of them cannot act.
    pub(crate) fn extended_by<'c>(&self, mut added: impl Iterator<Item = &'c Candidate>) -> Option<Model> {
        added.try_fold(self.model.clone(), |model, candidate| extended(&model, candidate))
    }
}

/// A fold: the recordings that are fitted, and the block that is left out.
struct Fold {
    fitted: Vec<Dataset>,
    left_out: Dataset,
}

/// Training recordings, folds and settings that all fits share.
pub(crate) struct Context<'a> {
    pub(crate) training: &'a [Dataset],
    pub(crate) fit: FitOptions,
    pub(crate) options: &'a Options,
    /// Inputs whose behaviour between samples the model file does not state.
    pub(crate) open_inputs: Vec<String>,
    /// What became of each candidate.
    pub(crate) journal: Journal,
    /// Empty where whole recordings are left out.
    folds: Vec<Fold>,
    /// Windows of the recordings, on which many models are compared first; `None` where the recordings are short.
    excerpt: Option<Excerpt>,
}

impl<'a> Context<'a> {
    /// `model` is that of the file: it says which inputs are open.
    pub(crate) fn new(
        model: &Model,
        training: &'a [Dataset],
        fit: FitOptions,
        options: &'a Options,
    ) -> Result<Self, IdentifyError> {
        let folds = if training.len() < FEW { block_folds(model, training)? } else { Vec::new() };
        let open = model.inputs().filter(|input| input.between.is_none());
        let open_inputs = open.map(|input| input.name.clone()).collect();
        let excerpt = Excerpt::new(&Problem::new(model, training, fit.clone())?, EXCERPT_ROWS);
        Ok(Self { training, fit, options, open_inputs, journal: Journal::default(), folds, excerpt })
    }

    /// The same, with notes in a journal that was begun before.
    pub(crate) fn noting_in(self, journal: Journal) -> Self {
        Self { journal, ..self }
    }

    /// Cross-validation scheme: by whole recordings or by blocks.
    pub(crate) fn validation(&self) -> Validation {
        if self.folds.is_empty() { Validation::LeaveOneOut } else { Validation::Blocks }
    }

    /// Whether the search was ended. Descents then stay where they are, and nothing may be decided by their fits: what was decided before
    /// stays.
    pub(crate) fn stops(&self) -> bool {
        self.fit.progress.stops()
    }

    /// The fit of a model to all training recordings.
    pub(crate) fn problem<'m>(&'m self, model: &'m Model) -> Result<Problem<'m>, IdentifyError> {
        Problem::new(model, self.training, self.fit.clone())
    }

    /// The same for a fit whose result is of no use once the search is ended: it is then given up at once.
    pub(crate) fn tentative<'m>(&'m self, model: &'m Model) -> Result<Problem<'m>, IdentifyError> {
        Problem::new(model, self.training, self.tentative_fit())
    }

    /// The same on an excerpt of long recordings.
    pub(crate) fn brief<'m>(&'m self, model: &'m Model) -> Result<Problem<'m>, IdentifyError> {
        let whole = self.tentative(model)?;
        Ok(match &self.excerpt {
            Some(excerpt) => whole.on(excerpt),
            None => whole,
        })
    }

    /// Whether [`Context::brief`] leaves rows out.
    pub(crate) fn is_long(&self) -> bool {
        self.excerpt.is_some()
    }

    /// A model fitted to the excerpt, from its fit to the whole recordings, which it is where they are short. `None` where the prediction
    /// overflows.
    pub(crate) fn fitted_in_brief(
        &self,
        FittedModel { model, at, .. }: &FittedModel,
        noise: &NoiseModel,
    ) -> Result<Option<Evaluation>, IdentifyError> {
        let Some(excerpt) = &self.excerpt else { return Ok(Some(at.clone())) };
        let Some(begun) = comparison::on_excerpt(&self.problem(model)?, noise, at, excerpt)? else {
            return Ok(None);
        };
        let round = (comparison::COARSE, REFIT_ITERATIONS);
        comparison::descend(&self.brief(model)?, noise, &at.values, Some((model, &begun)), round)
    }

    /// Settings of such a fit.
    pub(crate) fn tentative_fit(&self) -> FitOptions {
        let progress = self.fit.progress.clone().tentative();
        FitOptions { progress, ..self.fit.clone() }
    }

    /// Noise model of sensor noise alone, with filters that follow from `model` at `values`.
    pub(crate) fn sensor_noise(
        &self,
        model: &Model,
        values: &[f64],
        levels: NoiseLevels,
    ) -> Result<NoiseModel, IdentifyError> {
        NoiseModel::new(&[&self.problem(model)?], values, levels)
    }

    /// Noise model of sensor noise and model discrepancy, estimated from the residuals of a model at a fit. `before` holds the noise levels
    /// from which the estimate starts.
    pub(crate) fn noise_at(
        &self,
        model: &Model,
        at: &Evaluation,
        before: &NoiseLevels,
    ) -> Result<Option<NoiseModel>, IdentifyError> {
        let problem = self.problem(model)?;
        let levels = comparison::noise(&problem, at, before)?;
        let sensors = self.sensor_noise(model, &at.values, levels)?;
        let noise = sensors.with_discrepancy(&problem, at)?;
        if noise.as_ref().is_none_or(|noise| noise.excess() < FAR_BEYOND_NOISE) {
            return Ok(noise);
        }
        // The inputs' noise is negligible beside such residuals, and its filter need not resemble their spectrum.
        sensors.with_exact_inputs().with_discrepancy(&problem, at)
    }

    /// Fits a model from `values` and cross-validates it. `None` where its prediction overflows.
    pub(crate) fn fitted(
        &self,
        model: &Model,
        values: &[f64],
        from: Option<(&Model, &Evaluation)>,
        noise: &NoiseModel,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        self.fitted_within(ITERATIONS, (model, values), from, noise)
    }

    /// Continues a fit to its end and cross-validates it.
    pub(crate) fn settled(
        &self,
        FittedModel { model, at, .. }: &FittedModel,
        noise: &NoiseModel,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        self.fitted_within(LAST_ITERATIONS, (model, &at.values), Some((model, at)), noise)
    }

    fn fitted_within(
        &self,
        iterations: usize,
        (model, values): (&Model, &[f64]),
        from: Option<(&Model, &Evaluation)>,
        noise: &NoiseModel,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let round = (comparison::FINE, iterations);
        let at = comparison::descend(&self.problem(model)?, noise, values, from, round)?;
        at.map_or(Ok(None), |at| self.validated(model, at, noise))
    }

    /// Continues a fit under another noise model and cross-validates it.
    pub(crate) fn refitted(
        &self,
        fitted: &FittedModel,
        noise: &NoiseModel,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        self.fitted(&fitted.model, &fitted.at.values, Some((&fitted.model, &fitted.at)), noise)
    }

    /// Continues a fit under another noise model for at most [`REFIT_ITERATIONS`], as exactly as a comparison of models needs, and
    /// cross-validates it. `None` also where the search is ended.
    pub(crate) fn compared(
        &self,
        model: &Model,
        at: &Evaluation,
        noise: &NoiseModel,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let round = (comparison::COARSE, REFIT_ITERATIONS);
        let at = comparison::descend(&self.tentative(model)?, noise, &at.values, Some((model, at)), round)?;
        at.filter(|_| !self.stops()).map_or(Ok(None), |at| self.validated(model, at, noise))
    }

    /// Cross-validates a model at a given fit. Once the search is ended the fits of the folds are left out, as no choice depends on them.
    pub(crate) fn validated(
        &self,
        model: &Model,
        at: Evaluation,
        noise: &NoiseModel,
    ) -> Result<Option<FittedModel>, IdentifyError> {
        let validation = cross_validation::leave_one_out(&self.problem(model)?, noise, model, &at)?;
        let Some(mut validation) = validation else { return Ok(None) };
        if !self.folds.is_empty() && !self.stops() {
            let each = self.folds.par_iter().map(|fold| self.left_out(fold, model, &at, noise));
            let held_out: Result<Option<Vec<f64>>, IdentifyError> = each.collect();
            let Some(held_out) = held_out? else { return Ok(None) };
            validation.held_out = held_out;
        }
        Ok(Some(FittedModel { model: model.clone(), at, validation }))
    }

    /// Sum of squared residuals of a fold's block, at parameters fitted to the other blocks.
    fn left_out(
        &self,
        fold: &Fold,
        model: &Model,
        at: &Evaluation,
        noise: &NoiseModel,
    ) -> Result<Option<f64>, IdentifyError> {
        let others = Problem::new(model, &fold.fitted, self.fit.clone())?;
        let round = (comparison::COARSE, REFIT_ITERATIONS);
        let Some(refit) = comparison::descend(&others, noise, &at.values, None, round)? else {
            return Ok(None);
        };
        let block = Problem::new(model, std::slice::from_ref(&fold.left_out), self.fit.clone())?;
        Ok(comparison::measure(&block, noise, &refit.values)?.map(|evaluation| evaluation.total()))
    }
}

/// Descends in rounds of `(iterations, multiple)`: after a round the descent continues only if the sum of squares is at most `multiple`
/// times `best`. A descent that converges early must meet the last round's multiple. `None` if the descent was given up.
pub(crate) fn descend_in_rounds(
    problem: &Problem<'_>,
    noise: &NoiseModel,
    values: &[f64],
    best: f64,
    rounds: &[(usize, f64)],
) -> Result<Option<Evaluation>, IdentifyError> {
    let mut at: Option<Evaluation> = None;
    for (iterations, most_times) in rounds {
        let begin = at.as_ref().map_or(values, |at| &*at.values);
        let from = at.as_ref().map(|at| (problem.model(), at));
        let next = comparison::descend(problem, noise, begin, from, (comparison::COARSE, *iterations))?;
        at = next.filter(|next| next.total() < most_times * best);
        if at.as_ref().is_none_or(|at| at.converged) {
            break;
        }
    }
    let most = rounds.last().map_or(f64::INFINITY, |(_, most_times)| most_times * best);
    Ok(at.filter(|at| at.total() < most))
}

/// Folds of a few recordings, one for each of [`BLOCKS`] blocks.
fn block_folds(model: &Model, training: &[Dataset]) -> Result<Vec<Fold>, RecordingError> {
    let mut folds = Vec::new();
    let blocks = BLOCKS / training.len().max(1);
    for (index, dataset) in training.iter().enumerate() {
        for block in 0..blocks {
            let (without, left_out) = without_block(model, dataset, (block, blocks))?;
            let others = training.iter().enumerate().filter(|(other, _)| *other != index);
            let fitted = std::iter::once(without).chain(others.map(|(_, other)| other.clone())).collect();
            folds.push(Fold { fitted, left_out });
        }
    }
    Ok(folds)
}

/// A recording without the outputs of a block, and the recording with only those. Inputs stay complete in both, so that angles, time and
/// the start state are those of the whole recording.
fn without_block(
    model: &Model,
    dataset: &Dataset,
    (block, blocks): (usize, usize),
) -> Result<(Dataset, Dataset), RecordingError> {
    let edge = |block: usize| dataset.rows() * block as u64 / blocks as u64;
    let (from, to) = (edge(block), edge(block + 1));
    let missing = |rows: &[Range<u64>]| {
        let outputs = model.outputs().filter(|channel| !channel.quantity.is_clock());
        masked(dataset, outputs.map(|channel| (channel.column.as_str(), rows.to_vec())))
    };
    let block = from..to;
    Ok((missing(std::slice::from_ref(&block))?, missing(&[0..from, to..dataset.rows()])?))
}
